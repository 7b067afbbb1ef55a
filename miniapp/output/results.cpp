#include "miniapp/output/results.hpp"

#include "contact/base/messages/exchange_plan.hpp"
#include "contact/base/region.hpp"
#include "contact/base/to_device.hpp"
#include "mechanics/element/stress_measures.hpp"
#include "mechanics/step/nodal_motion.hpp"
#include "miniapp/deck/words.hpp"
#include "miniapp/output/contact_pressure.hpp"
#include "miniapp/output/history_columns.hpp"
#include "miniapp/output/report.hpp"

#include <algorithm>

namespace brickwall::miniapp {

namespace {

// The variables of a field: its name with each of these suffixes.
struct Variables {
  bool are_nodal;
  std::vector<const char*> suffixes;
};
Variables variablesOf(OutputField field) {
  switch (field) {
  case OutputField::displacement:
  case OutputField::velocity:
  case OutputField::force_contact:
  case OutputField::slip_velocity:
    return {true, {"_x", "_y", "_z"}};
  case OutputField::contact_status:
  case OutputField::contact_gap:
  case OutputField::contact_pressure:
  case OutputField::slip_distance:
    return {true, {""}};
  case OutputField::stress:
    return {false, {"_xx", "_yy", "_zz", "_xy", "_yz", "_zx"}};
  case OutputField::principal_stress:
    return {false, {"_1", "_2", "_3"}};
  case OutputField::brick_id:
  case OutputField::processor_id:
    return {false, {}}; // by io::ResultsWriter
  default:
    return {false, {""}};
  }
}

io::ResultsConfig asTemporary(io::ResultsConfig config) {
  config.temporary_suffix = EarlierResults::new_suffix;
  return config;
}

} // namespace

io::ResultsConfig resultsConfig(const Config& config) {
  io::ResultsConfig results;
  results.title = config.title;
  results.version = versionText();
  results.information = config.resolved_deck;
  for (const auto& entry : wordsOf(OutputField()))
    if (config.output.has(entry.value)) {
      const Variables variables = variablesOf(entry.value);
      for (const char* suffix : variables.suffixes)
        (variables.are_nodal ? results.nodal_names : results.element_names)
            .push_back(entry.word + std::string(suffix));
    }
  results.global_names = globalNames(config);
  results.write_brick_id = config.output.has(OutputField::brick_id);
  results.write_processor_id = config.output.has(OutputField::processor_id);
  results.single_precision = config.output.precision == Precision::float32;
  results.format = config.output.file_format;
  return results;
}

Results::Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene,
                 const PhaseRecorder& recorder)
    : Results(comm, base, resultsConfig(config), config, scene, recorder) {}

Results::Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene,
                 const PhaseRecorder& recorder, const EarlierResults& earlier)
    : Results(comm, base, asTemporary(resultsConfig(config)), config, scene, recorder) {
  earlier.copyTo(_writer, scene.part);
  earlier.replaceBy(_writer);
}

Results::Results(MPI_Comm comm, const std::string& base, const io::ResultsConfig& results,
                 const Config& config, const Scene& scene, const PhaseRecorder& recorder)
    : _scene(scene), _recorder(recorder), _shared(scene.shared),
      _writer(comm, base + ".exo", scene.part, results), _nodal_names(results.nodal_names),
      _element_names(results.element_names),
      _nodal(_nodal_names.size(), std::vector<double>(scene.part.node_ids.size())),
      _element(_element_names.size(), std::vector<double>(scene.part.elem_ids.size())) {
  const bool has_slip = config.output.has(OutputField::slip_velocity);
  _contact_words = View<std::int64_t**>("miniapp::Results::contact_words",
                                        scene.part.node_ids.size(), has_slip ? 5 : 2);
}

std::vector<double>* Results::valuesOf(OutputField field) {
  const Variables variables = variablesOf(field);
  const auto& names = variables.are_nodal ? _nodal_names : _element_names;
  const auto first = std::find(names.begin(), names.end(),
                               nameOf(field) + std::string(variables.suffixes.front()));
  if (first == names.end())
    return nullptr;
  return &(variables.are_nodal ? _nodal : _element)[first - names.begin()];
}

void Results::writeStep(Simulation& simulation) {
  const Region region("miniapp::output");
  fillMotion(simulation);
  if (simulation.contact()) { // otherwise the fields are zero
    fillContact(simulation);
    fillSearch(simulation);
  }
  fillStress(simulation);
  _writer.writeStep(simulation.clock().time, _nodal, _element, globalValues(simulation));
}

// Displacement and contact force at t^n; velocity at t^n from that of the half step after it,
// v^{n+1/2} - dt/2 a^n.
void Results::fillMotion(Simulation& simulation) {
  auto* const displacement = valuesOf(OutputField::displacement);
  auto* const velocity = valuesOf(OutputField::velocity);
  auto* const contact_force = valuesOf(OutputField::force_contact);
  if (displacement) {
    const auto u = toHost(simulation.state().displacement);
    for (int d = 0; d < 3; ++d)
      for (int node = 0; node < _scene.mesh.num_nodes; ++node)
        displacement[d][node] = u(node, d);
  }
  if (!velocity && !contact_force)
    return;
  const mechanics::NodalForces& forces = simulation.forces();
  const auto values = toHost(forces.values);
  if (contact_force)
    for (int d = 0; d < 3; ++d)
      for (int node = 0; node < _scene.mesh.num_nodes; ++node)
        contact_force[d][node] =
            static_cast<double>(values(node, 3 * mechanics::contact_force + d)) *
            forces.quantum.value;
  if (!velocity)
    return;
  const auto v = toHost(simulation.state().velocity);
  const auto mass = toHost(simulation.state().mass);
  const auto& boundary = simulation.boundary();
  const auto motion = toHost(boundary.motion());
  const auto nodal_motion = nodalMotion(forces, values, mass, motion, boundary);
  const double half_step = 0.5 * simulation.clock().dt;
  for (int d = 0; d < 3; ++d)
    for (int node = 0; node < _scene.mesh.num_nodes; ++node)
      velocity[d][node] = nodal_motion.velocityBefore(node, d, v(node, d), half_step);
}

void Results::fillContact(Simulation& simulation) {
  auto* const status = valuesOf(OutputField::contact_status);
  auto* const gap = valuesOf(OutputField::contact_gap);
  auto* const slip = valuesOf(OutputField::slip_velocity);
  if (auto* const pressure = valuesOf(OutputField::contact_pressure))
    *pressure = contactPressure(simulation, _shared);
  if (auto* const distance = valuesOf(OutputField::slip_distance)) {
    const auto words = toHost(simulation.contact()->slipOnMesh());
    for (int node = 0; node < _scene.mesh.num_nodes; ++node)
      fromWord(words(node, 0), (*distance)[node]);
  }
  if (!status && !gap && !slip)
    return;
  simulation.contact()->statusOnMesh(_shared, _contact_words);
  const Clock& clock = simulation.clock();
  const auto host = toHost(_contact_words);
  for (int node = 0; node < _scene.mesh.num_nodes; ++node) {
    if (status)
      (*status)[node] = static_cast<double>(host(node, 0));
    if (gap)
      fromWord(host(node, 1), (*gap)[node]);
    for (int d = 0; slip && !clock.isAtStart() && d < 3; ++d) {
      fromWord(host(node, 2 + d), slip[d][node]);
      slip[d][node] /= clock.dt_before;
    }
  }
}

void Results::fillStress(const Simulation& simulation) {
  auto* const stress = valuesOf(OutputField::stress);
  auto* const pressure = valuesOf(OutputField::pressure);
  auto* const density = valuesOf(OutputField::energy_density);
  auto* const von_mises = valuesOf(OutputField::von_mises);
  auto* const principal = valuesOf(OutputField::principal_stress);
  auto* const energy = valuesOf(OutputField::strain_energy);
  if (!stress && !pressure && !density && !von_mises && !principal && !energy)
    return;
  simulation.internalForce().computeFields(_space, simulation.state().displacement, _fields);
  const auto all_stresses = toHost(_fields.stress);
  const auto all_pressures = toHost(_fields.pressure);
  const auto all_densities = toHost(_fields.energy_density);
  const auto all_energies = toHost(_fields.stored_energy);
  for (int elem = 0; elem < _scene.mesh.num_elems; ++elem) {
    double sigma[6], principal_stress[3];
    for (int c = 0; c < 6; ++c)
      sigma[c] = all_stresses(elem, c);
    for (int c = 0; stress && c < 6; ++c)
      stress[c][elem] = sigma[c];
    if (pressure)
      (*pressure)[elem] = all_pressures(elem);
    if (density)
      (*density)[elem] = all_densities(elem);
    if (von_mises)
      (*von_mises)[elem] = mechanics::vonMises(sigma);
    if (principal)
      mechanics::principalStresses(sigma, principal_stress);
    for (int c = 0; principal && c < 3; ++c)
      principal[c][elem] = principal_stress[c];
    if (energy)
      (*energy)[elem] = all_energies(elem);
  }
}

void Results::fillSearch(Simulation& simulation) {
  if (auto* const seconds = valuesOf(OutputField::search_time))
    std::fill(seconds->begin(), seconds->end(), _recorder.seconds("contact::search"));
  auto* const pairs = valuesOf(OutputField::candidate_pairs);
  if (!pairs)
    return;
  std::fill(pairs->begin(), pairs->end(), 0.0);
  const std::vector<std::int64_t> counts = simulation.contact()->candidatesOfFaces();
  const auto face_to_elem = toHost(_scene.skin.face_to_elem);
  for (int face = 0; face < _scene.skin.num_faces; ++face)
    (*pairs)[face_to_elem(face)] += static_cast<double>(counts[face]);
}

} // namespace brickwall::miniapp
