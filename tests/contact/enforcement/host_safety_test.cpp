// Enforcement in a host code: messages of the host that have the library's tags, wrong surfaces,
// and configurations that differ between ranks. Every error is thrown on all ranks; no rank hangs.
#include "tests/contact/enforcement/support/edge_run.hpp"
#include "tests/contact/support/host_traffic.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace brickwall::contact::testing {
namespace {

using test::HostTraffic;

class EnforcementInHost : public ::testing::Test {
protected:
  const int rank = rankOf(comm), size = sizeOf(comm);
};

// The message with which `act` throws InputError on all ranks; empty if it does not.
std::string messageOf(const std::function<void()>& act) {
  std::string message;
  try {
    act();
  } catch (const InputError& error) {
    message = error.what();
  }
  EXPECT_EQ(broadcast(comm, message), message);
  return message;
}
void expectError(const std::function<void()>& act, const std::string& words) {
  const std::string message = messageOf(act);
  EXPECT_NE(message.find(words), std::string::npos) << words << ": " << message;
}

// Contact with forces is the same beside pending messages of the host, which arrive unharmed.
template <class Run>
void expectSameBesideTraffic(const Scene& scene) {
  Run alone(scene, comm, scattered);
  const auto expected = alone.step();
  EXPECT_GT(alone.sums.active, 0);
  for (const auto kind : {HostTraffic::pending_receives, HostTraffic::pending_messages}) {
    HostTraffic traffic(comm, kind);
    Run run(scene, comm, scattered);
    EXPECT_EQ(run.step(), expected);
    EXPECT_TRUE(traffic.hasArrived());
  }
}

TEST_F(EnforcementInHost, MessagesOfTheHostDoNotMeetThoseOfTheEnforcement) {
  expectSameBesideTraffic<SceneRun>(pressed());
}

TEST_F(EnforcementInHost, MessagesOfTheHostDoNotMeetThoseOfTheEdges) {
  Scene scene = crossedRidges(0.001);
  scene.step();
  scene.move(1, {0, 0, -0.01});
  expectSameBesideTraffic<EdgeRun>(scene);
}

struct Given {
  Surface surface;
  View<const double*> node_mass;
  EnforcementConfig enforcement;
  SearchConfig search;
  Quantum force_quantum = quantum();
  LimbScale energy_scale = energyScale();
};

struct BadParameter {
  std::string words; // of the message
  std::function<void(Given&)> set;
};

std::vector<BadParameter> badParameters() {
  const double nan = std::nan("");
  std::vector<BadParameter> all;
  const auto add = [&](const std::string& name, double EnforcementConfig::*parameter,
                       const std::vector<double>& values) {
    for (const double value : values)
      all.push_back({name + " is ", [=](Given& g) { g.enforcement.*parameter = value; }});
  };
  add("penalty", &EnforcementConfig::penalty, {nan, 0, HUGE_VAL});
  add("reference_step", &EnforcementConfig::reference_step, {nan, 0, HUGE_VAL});
  add("lateral_tolerance", &EnforcementConfig::lateral_tolerance, {nan, -0.1});
  add("edge_tolerance", &EnforcementConfig::edge_tolerance, {nan, -0.1});
  add("friction", &EnforcementConfig::friction, {nan, -0.3, HUGE_VAL});
  add("friction_stiffness", &EnforcementConfig::friction_stiffness, {nan, -1});
  add("damping", &EnforcementConfig::damping, {nan, -0.05});
  add("least_depth", &EnforcementConfig::least_depth, {nan, -1e-12});
  add("max_activation_depth", &EnforcementConfig::max_activation_depth, {nan, -1});
  add("opposed_cosine", &EnforcementConfig::opposed_cosine, {nan, 1.1});
  add("shared_cosine", &EnforcementConfig::shared_cosine, {nan, -1.1});
  all.push_back(
      {"corrections is 0; expected 1 or more", [](Given& g) { g.enforcement.corrections = 0; }});
  for (const double value : {nan, 0.0, -1.0}) {
    all.push_back({"quantum is ", [=](Given& g) { g.force_quantum.value = value; }});
    all.push_back({"energy_scale is ", [=](Given& g) { g.energy_scale.high_quantum = value; }});
  }
  return all;
}

TEST_F(EnforcementInHost, EnforcementChecksWhatItIsGiven) {
  const exec_space space;
  const ScenePart part(pressed(), comm, scattered, 0.3);
  const FeatureEdges edges = findFeatureEdges(comm, part.surface());
  int first_wrong = 0; // rank
  const auto expect = [&](const std::string& words, const std::function<void(Given&)>& spoil) {
    Given given{part.surface(), part.nodeMass(), config(), searchOf(0.2)};
    if (rank >= first_wrong)
      spoil(given);
    const auto make = [&] {
      Enforcement(space, comm, given.surface, given.node_mass, given.enforcement,
                  given.force_quantum, given.energy_scale);
    };
    const auto makeEdges = [&] {
      EdgeContact(space, comm, given.surface, edges, given.node_mass, given.search, 0,
                  given.enforcement, given.force_quantum, given.energy_scale);
    };
    expectError(make, words);
    expectError(makeEdges, words);
  };
  for (const BadParameter& parameter : badParameters())
    expect(parameter.words, parameter.set);
  first_wrong = size - 1;
  const std::string where = "rank " + std::to_string(size - 1);
  expect(where + ": face_ids is missing", [](Given& g) { g.surface.face_ids = {}; });
  expect(where + ": num_nodes is -3", [](Given& g) { g.surface.num_nodes = -3; });
  expect(where + " has 0 rows of node_mass", [](Given& g) { g.node_mass = {}; });
  expect(where + " has face_ids(0) = 1152921504606846976; expected less than 2^60", [](Given& g) {
    View<global_id*> ids("test::ids", g.surface.num_faces);
    const auto host = Kokkos::create_mirror_view(ids);
    for (int face = 0; face < g.surface.num_faces; ++face)
      host(face) = (global_id(1) << 60) + face;
    Kokkos::deep_copy(ids, host);
    g.surface.face_ids = ids;
  });
  expect("words of attributes", [](Given& g) {
    g.surface.face_attributes = AttributeWords("test::attributes", g.surface.num_faces, 3);
  });
  if (size == 1)
    return;
  expect("scheme is energy_neutral on " + where,
         [](Given& g) { g.enforcement.scheme = Scheme::energy_neutral; });
  expect("penalty is 0.5", [](Given& g) { g.enforcement.penalty = 0.5; });
  expect("reference_step", [](Given& g) { g.enforcement.reference_step = 0; });
  expect("friction", [](Given& g) { g.enforcement.friction = 0.3; });
  expect("skip_stationary", [](Given& g) { g.enforcement.skip_stationary = false; });
}

TEST_F(EnforcementInHost, AToleranceOfEdgesThatCannotBeIsAnErrorOfTheNextSearch) {
  EdgeRun run(crossedRidges(-0.02), comm, scattered);
  run.step();
  if (rank == size - 1)
    run.edges->setTolerance(-1);
  expectError([&] { run.step(); }, "tolerance");
  run.edges->setTolerance(0.1);
  EXPECT_EQ(messageOf([&] { run.step(); }), "");
}

TEST_F(EnforcementInHost, EnforcementNoticesASurfaceOfOtherCounts) {
  const exec_space space;
  SceneRun run(pressed(), comm, scattered);
  const auto expected = run.step();
  Surface other = run.part.surface();
  if (rank == size - 1)
    --other.num_faces;
  for (int step = 0; step < 2; ++step)
    expectError(
        [&] { run.enforcement.enforce(space, other, run.part.ghosts(), run.part.pairs(), dt); },
        "Enforcement::enforce: rank " + std::to_string(size - 1) + " has ");
}

} // namespace
} // namespace brickwall::contact::testing
