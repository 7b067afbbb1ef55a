#include "miniapp/simulation/step_failure.hpp"

#include "contact/base/mpi.hpp"
#include "miniapp/scene/entity_names.hpp"
#include "miniapp/simulation/simulation.hpp"

#include <sstream>

namespace brickwall::miniapp {

namespace {

// A node of mass m and speed v is stopped by the force sqrt(k m) v = sqrt(s) m v/dt with k = s
// m/dt^2 and s = contact.penalty. Half of the range of forces suffices for s (range/(2 F))^2, where
// F is the force found.
std::string remedyFor(double excess, const Simulation& simulation) {
  std::ostringstream message;
  for (const StepCut& cut : simulation.steps().cuts())
    if (cut.reason == StepCut::Reason::tunnelling) {
      message << "The step was cut from " << cut.from
              << " so that nodes are stopped within contact.tolerance: raise contact.tolerance or "
                 "slow the bodies down";
      return message.str();
    }
  const double part = minOf(0.5 / excess, 1.0);
  message.precision(1);
  message << "The stiffness of contact is k = contact.penalty m/dt^2: lengthen the step "
             "(time.safety, the size of the smallest elements), or soften contact by "
             "contact.penalty = "
          << simulation.config().contact.penalty * part * part;
  return message.str();
}

std::string describeLargestForce(const Simulation& simulation) {
  const contact::LargestForce largest = simulation.contact()->largestForce();
  if (!(largest.force > 0))
    return "";
  const auto body = [&](global_id id) {
    return bodyName(simulation.comm(), simulation.config(), simulation.scene().part, id);
  };
  const double range = contact::largestPairForce(simulation.forceQuantum());
  std::ostringstream message;
  message << "; the largest, " << largest.force << ", is that of "
          << (largest.is_of_edges ? edgeName(largest.node) : nodeName(largest.node)) << " of "
          << body(largest.node_body) << " and "
          << (largest.is_of_edges ? edgeName(largest.face) : faceName(largest.face)) << " of "
          << body(largest.face_body) << ". The range ends at " << range
          << ", a multiple of (lambda + 2 mu) h^2 of the strongest element";
  if (largest.force < HUGE_VAL)
    message << ". " << remedyFor(largest.force / range, simulation);
  return message.str();
}

} // namespace

std::string describeFailure(const Simulation& simulation) {
  const MPI_Comm comm = simulation.comm();
  const Clock& clock = simulation.clock();
  const auto failure = mechanics::agreeOnFailure(simulation.space(), comm, simulation.scene().mesh,
                                                 simulation.lastStep().internal.failure);
  contact::EnforcementSums sums = simulation.lastStep().contact;
  contact::sumOverRanks(comm, sums.nodes);
  contact::sumOverRanks(comm, sums.edges);
  std::ostringstream message;
  message << "the computation broke down in step " << clock.step << " (time " << clock.time
          << "): ";
  if (failure.count > 0)
    message << mechanics::describe(failure);
  else if (sums.failures() > 0)
    message << (sums.nodes.failures() > 0 ? sums.nodes : sums.edges).problem()
            << (sums.nodes.invalid + sums.edges.invalid > 0 ? describeLargestForce(simulation)
                                                            : "");
  else
    message << "a load or an energy is not finite or beyond the range of the exact sums";
  return message.str();
}

} // namespace brickwall::miniapp
