// What a simulation hands to restart files and takes from them.
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "miniapp/simulation/simulation.hpp"

namespace brickwall::miniapp {

namespace {

// Row by row, whatever the layout of the View.
template <class T, class ViewType>
std::vector<T> rowsOf(const ViewType& view) {
  const auto host = toHost(view);
  std::vector<T> rows;
  rows.reserve(host.size());
  for (std::size_t i = 0; i < host.extent(0); ++i)
    for (std::size_t j = 0; j < host.extent(1); ++j)
      rows.push_back(host(i, j));
  return rows;
}

template <class T, class ViewType>
void setRows(const ViewType& view, const std::vector<T>& rows) {
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t i = 0; i < host.extent(0); ++i)
    for (std::size_t j = 0; j < host.extent(1); ++j)
      host(i, j) = rows.at(i * host.extent(1) + j);
  Kokkos::deep_copy(view, host);
}

} // namespace

SimulationRestart Simulation::restartData() const {
  _space.fence();
  SimulationRestart data;
  data.steps = _steps.restartData();
  data.ledger = _ledger;
  data.load_span = _step.load_span;
  data.previous_load_span = _step.previous_load_span;
  data.forces_act = _forces.acts;
  data.guarded_steps = _guarded_steps;
  data.skipped_element_steps = allReduce(_comm, _skipped_element_steps, MPI_SUM);
  data.displacement = rowsOf<double>(_state.displacement);
  data.velocity = rowsOf<double>(_state.velocity);
  data.keeps_forces = _contact && balance().fast_nodes > 0;
  if (data.keeps_forces)
    data.forces = rowsOf<std::int64_t>(_forces.values);
  if (_contact) {
    data.contact = _contact->restartData(_step.contact);
    data.slip = rowsOf<std::int64_t>(_contact->slipOnMesh());
  }
  return data;
}

void Simulation::restore(const SimulationRestart& data) {
  _ahead.dt = 0;
  setRows(_state.displacement, data.displacement);
  setRows(_state.velocity, data.velocity);
  if (data.keeps_forces)
    setRows(_forces.values, data.forces);
  _forces.acts = data.forces_act;
  _steps.restore(data.steps);
  _ledger = data.ledger;
  _step.load_span = data.load_span;
  _step.previous_load_span = data.previous_load_span;
  _guarded_steps = data.guarded_steps;
  _skipped_element_steps = rankOf(_comm) == 0 ? data.skipped_element_steps : 0;
  findRestingBodies(); // anew: bodies have moved
  if (_contact) {
    _contact->restore(data.contact, _state.displacement, _step.contact);
    const View<std::int64_t**> slip("miniapp::Simulation::slip", data.slip.size(), 1);
    setRows(slip, data.slip);
    _contact->setSlip(slip);
  }
  _requests = {};
}

} // namespace brickwall::miniapp
