#include "miniapp/output/results.hpp"

#include "contact/base/exchange_plan.hpp"
#include "contact/base/region.hpp"
#include "contact/base/to_device.hpp"
#include "mechanics/step/nodal_motion.hpp"
#include "miniapp/output/history_columns.hpp"
#include "miniapp/output/report.hpp"

namespace brickwall::miniapp {

namespace {

const std::vector<std::string> nodal_names = {
    "displacement_x",  "displacement_y", "displacement_z",  "velocity_x",
    "velocity_y",      "velocity_z",     "force_contact_x", "force_contact_y",
    "force_contact_z", "contact_status", "contact_gap"};
const std::vector<std::string> element_names = {"stress_xx", "stress_yy",     "stress_zz",
                                                "stress_xy", "stress_yz",     "stress_zx",
                                                "pressure",  "energy_density"};

io::ResultsConfig asTemporary(io::ResultsConfig config) {
  config.temporary_suffix = ".new";
  return config;
}

} // namespace

io::ResultsConfig resultsConfig(const Config& config) {
  io::ResultsConfig results;
  results.title = config.title;
  results.version = versionText();
  results.information = config.resolved_deck;
  results.nodal_names = nodal_names;
  results.element_names = element_names;
  results.global_names = globalNames(config);
  results.write_processor_id = config.output.processor_id;
  results.single_precision = config.output.precision == Precision::float32;
  results.format = config.output.file_format;
  return results;
}

Results::Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene)
    : Results(comm, base, resultsConfig(config), scene) {}

Results::Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene,
                 const EarlierResults& earlier)
    : Results(comm, base, asTemporary(resultsConfig(config)), scene) {
  earlier.copyTo(_writer, scene.part);
  _writer.rename();
  earlier.removeReplaced();
}

Results::Results(MPI_Comm comm, const std::string& base, const io::ResultsConfig& config,
                 const Scene& scene)
    : _scene(scene), _shared(scene.shared), _writer(comm, base + ".exo", scene.part, config),
      _nodal(nodal_names.size(), std::vector<double>(scene.part.node_ids.size())),
      _element(element_names.size(), std::vector<double>(scene.part.elem_ids.size())),
      _contact_words("miniapp::ResultsWriter::contact_words", scene.part.node_ids.size(), 2) {}

void Results::writeStep(Simulation& simulation) {
  const Region region("miniapp::output");
  fillNodal(simulation);
  fillContact(simulation);
  fillElement(simulation);
  _writer.writeStep(simulation.clock().time, _nodal, _element, globalValues(simulation));
}

// Displacement and contact force at t^n; velocity at t^n from that of the half step after it,
// v^{n+1/2} - dt/2 a^n.
void Results::fillNodal(Simulation& simulation) {
  const mechanics::NodalForces& forces = simulation.forces();
  const auto u = toHost(simulation.state().displacement);
  const auto v = toHost(simulation.state().velocity);
  const auto mass = toHost(simulation.state().mass);
  const auto values = toHost(forces.values);
  const auto& boundary = simulation.boundary();
  const auto motion = toHost(boundary.motion());
  const double quantum = forces.quantum.value;
  const auto nodal_motion = nodalMotion(forces, values, mass, motion, boundary);
  const double half_step = 0.5 * simulation.clock().dt;
  for (int d = 0; d < 3; ++d)
    for (int node = 0; node < _scene.mesh.num_nodes; ++node) {
      _nodal[d][node] = u(node, d);
      _nodal[3 + d][node] = nodal_motion.velocityBefore(node, d, v(node, d), half_step);
      _nodal[6 + d][node] =
          static_cast<double>(values(node, 3 * mechanics::contact_force + d)) * quantum;
    }
}

void Results::fillContact(Simulation& simulation) {
  if (!simulation.contact())
    return;
  simulation.contact()->statusOnMesh(_shared, _contact_words);
  const auto host = toHost(_contact_words);
  for (int node = 0; node < _scene.mesh.num_nodes; ++node) {
    _nodal[9][node] = static_cast<double>(host(node, 0));
    fromWord(host(node, 1), _nodal[10][node]);
  }
}

void Results::fillElement(Simulation& simulation) {
  simulation.internalForce().computeFields(_space, simulation.state().displacement, _fields);
  const auto stress = toHost(_fields.stress);
  const auto pressure = toHost(_fields.pressure);
  const auto density = toHost(_fields.energy_density);
  for (int elem = 0; elem < _scene.mesh.num_elems; ++elem) {
    for (int c = 0; c < 6; ++c)
      _element[c][elem] = stress(elem, c);
    _element[6][elem] = pressure(elem);
    _element[7][elem] = density(elem);
  }
}

} // namespace brickwall::miniapp
