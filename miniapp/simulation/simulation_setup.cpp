// Set-up of a simulation: state, forces, loads, free and resting bodies, length of the steps,
// contact.
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "mechanics/ledger/turned_rounding.hpp"
#include "mechanics/mesh/lumped_mass.hpp"
#include "miniapp/scene/loads.hpp"
#include "miniapp/simulation/simulation.hpp"

#include <sstream>

namespace brickwall::miniapp {

namespace {

std::string excessiveDamping(double damping, double dt) {
  std::ostringstream message;
  message << "damping.mass: found " << damping << ", which reverses all motion in every step of "
          << dt << "; expected less than 2 over the step, " << 2 / dt;
  return message.str();
}

void markNodes(const std::vector<mechanics::PressureLoad>& loads, std::vector<char>& marks) {
  for (const auto& load : loads) {
    const auto faces = toHost(load.faceToNodes());
    for (std::size_t face = 0; face < faces.extent(0); ++face)
      for (int corner = 0; corner < 4; ++corner)
        marks[faces(face, corner)] = 1;
  }
}

} // namespace

Simulation::Simulation(MPI_Comm comm, const Config& config, const Scene& scene)
    : _comm(comm), _config(config), _scene(scene), _steps(comm, config, scene),
      _boundary(_space, scene.mesh.num_nodes, prescribedMotions(config, scene.part),
                toVec3(config.gravity), config.mass_damping),
      _shared(scene.shared) {
  const auto& mesh = scene.mesh;
  _state.mass = scene.mass;
  _state.displacement = View<double* [3]>("miniapp::Simulation::displacement", mesh.num_nodes);
  _state.velocity = View<double* [3]>("miniapp::Simulation::velocity", mesh.num_nodes);
  _forces.quantum = Quantum::forForceScale(mechanics::forceScale(_space, comm, mesh));
  allocateForces();
  _scales = mechanics::ledgerScales(_space, comm, mesh);
  const auto kind = config.formulation == Formulation::one_point ? mechanics::ElementKind::one_point
                                                                 : mechanics::ElementKind::full;
  _internal_force = std::make_unique<mechanics::InternalForce>(
      _space, comm, mesh, kind, _forces.quantum, _scales.energy, 0,
      config.skip.lattices ? mechanics::fastest_lattice_method : mechanics::LatticeMethod::none);
  _loads = pressureLoads(_space, comm, config, scene);
  findFreeBricks();
  setInitialDeformations(_space, config, scene, _shared, _state);
  if (!config.initial_deformations.empty())
    mechanics::raiseNoiseFloorForRotation(_space, comm, mesh, _state.displacement, _scales);
  setInitialVelocities(_space, config, scene, _shared, _boundary, _state);
  findRestingBodies();

  _steps.plan(kind, _state.displacement);
  if (config.mass_damping * clock().dt >= 2)
    throw InputError(excessiveDamping(config.mass_damping, clock().dt));
  if (config.contact.enabled && !fills_lanes) { // packs of nodes read all columns
    const View<unsigned char*> may_touch("miniapp::Simulation::may_touch", mesh.num_nodes);
    contact::flagListed(_space, {scene.skin.num_nodes, scene.skin.surface_to_node}, may_touch);
    _forces.may_touch = may_touch;
  }
  if (config.contact.enabled)
    _contact =
        std::make_unique<ContactStep>(_space, comm, config, scene, _boundary, _state.displacement,
                                      clock().dt, _forces.quantum, _scales.energy);
  _ledger = mechanics::EnergyLedger(comm, _scales, _boundary.gravity(),
                                    mechanics::totalMass(_space, comm, mesh, scene.mass),
                                    mechanics::motionOf(_space, mesh, _state, _scales));
  mesh.host.reset();
}

void Simulation::allocateForces() {
  _forces.values = mechanics::ForceColumns("miniapp::Simulation::forces", _scene.mesh.num_nodes,
                                           mechanics::numForceColumns(_config.viscosity.any()));
}

// Free bricks are moved only by their internal forces, gravity and prescribed motions.
void Simulation::findFreeBricks() {
  _other_nodes = mechanics::NodeSelection::allOf(_scene.mesh.num_nodes);
  if (_config.contact.enabled || _config.viscosity.any() || !host_accessible ||
      !_config.skip.free_bricks)
    return;
  std::vector<char> is_loaded(_scene.mesh.num_nodes, 0);
  markNodes(_loads, is_loaded);
  _free_bricks = mechanics::FreeBricks(_space, _scene.mesh, *_internal_force, is_loaded);
  if (_free_bricks.any())
    _other_nodes = _free_bricks.otherNodes();
}

// Forces reach a body through its surface and through loads, which may act on sides inside it; they
// reach this rank's part of a body also through shared nodes. Without contact few bodies ever start
// to move, so nothing is gained.
void Simulation::findRestingBodies() {
  if (!_config.skip.resting_bodies || !_config.contact.enabled)
    return;
  std::vector<char> may_be_pushed(_scene.mesh.num_nodes, 0);
  const auto surface = toHost(_scene.skin.surface_to_node);
  for (std::size_t s = 0; s < surface.extent(0); ++s)
    may_be_pushed[surface(s)] = 1;
  for (const auto& nodes : sharedNodes(_scene.part).nodes)
    for (const int node : nodes)
      may_be_pushed[node] = 1;
  markNodes(_loads, may_be_pushed);
  _resting =
      mechanics::RestingBodies(_space, _scene.mesh, _state, prescribedMotions(_config, _scene.part),
                               _boundary.gravity(), may_be_pushed);
  _internal_force->skipRestingBodies(_resting.flags());
}

} // namespace brickwall::miniapp
