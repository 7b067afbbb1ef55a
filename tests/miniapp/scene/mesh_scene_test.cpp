// Simulations of meshes with sets and elements that generated walls do not have.
#include "miniapp/scene/force_range.hpp"
#include "tests/miniapp/scene/mesh_scene.hpp"

namespace brickwall::miniapp::testing {
namespace {

// Two sides of the central element of 3 x 3 x 3; none of their nodes is on the surface.
io::SideSet sidesOfTheCentralElement() {
  io::SideSet inner;
  inner.id = 77;
  inner.name = "inner";
  inner.elems = {13, 13};
  inner.sides = {0, 1};
  return inner;
}

struct Outcome {
  Checksums checksums;
  double external_work = 0;
};
Outcome outcomeOf(MPI_Comm comm, const Config& config) {
  const Scene scene = makeScene(exec_space(), comm, config);
  Simulation simulation(comm, config, scene);
  simulation.start();
  while (!simulation.isDone())
    simulation.step();
  return {checksums(simulation), simulation.balance().external_work};
}

TEST(MeshScene, APressureInsideABodyMovesItTheSameOnAnyNumberOfRanks) {
  const MeshFile mesh(oneBrick({3, 3, 3}), [](io::MeshPart& part) {
    part.side_sets.push_back(sidesOfTheCentralElement());
  });
  const std::string load =
      "[[load.pressure]]\nside_set = \"inner\"\npeak = 1e-3\nshape = \"step\"\n";
  const Outcome alone = outcomeOf(MPI_COMM_SELF, mesh.config(load));
  EXPECT_GT(alone.external_work, 0);
  for (const std::string skip : {"", "[skip]\nresting_bodies = false\n"}) {
    const Outcome found = outcomeOf(MPI_COMM_WORLD, mesh.config(load + skip));
    EXPECT_EQ(found.external_work, alone.external_work) << skip;
    EXPECT_EQ(found.checksums.nodes, alone.checksums.nodes) << skip;
  }
}

// Node sets at x = 0 ("left") and at y = 0 ("front_nodes"), which share an edge, and an empty one.
void addNodeSets(io::MeshPart& part) {
  io::NodeSet left, front, nothing;
  left.id = 201, left.name = "left";
  front.id = 202, front.name = "front_nodes";
  nothing.id = 203, nothing.name = "nothing";
  for (int node = 0; node < part.numNodes(); ++node) {
    if (part.coordinates[3 * node] == 0)
      left.nodes.push_back(node);
    if (part.coordinates[3 * node + 1] == 0)
      front.nodes.push_back(node);
  }
  part.node_sets = {left, front, nothing};
}

TEST(MeshScene, SetsThatShareNodesAreRefusedIfTheirMotionsDiffer) {
  const MeshFile mesh(oneBrick({2, 2, 3}), addNodeSets);
  const std::string fixed = "[[boundary.fixed]]\nnode_set = \"left\"\n";
  const auto moved = [&](const char* motion) {
    return mesh.config(fixed + "[[boundary.velocity]]\nnode_set = \"front_nodes\"\n" + motion);
  };
  const std::string fault = faultOf(moved("velocity = [0.1, 0, -0.1]\n"));
  EXPECT_NE(fault.find("boundary.fixed[0] and boundary.velocity[0]"), std::string::npos) << fault;
  EXPECT_NE(fault.find("different motions of x, z of nodes"), std::string::npos) << fault;
  EXPECT_NE(fault.find("\"left\" and \"front_nodes\", 4 of them, the first node 0 (1-based id 1)"),
            std::string::npos)
      << fault;
  EXPECT_EQ(faultOf(moved("velocity = [0, 0, 0]\n")), ""); // they agree
  EXPECT_EQ(faultOf(mesh.config("[[boundary.fixed]]\nnode_set = \"left\"\ncomponents = [\"x\"]\n"
                                "[[boundary.velocity]]\nnode_set = \"front_nodes\"\n"
                                "velocity = [0, 0, 0.1]\ncomponents = [\"z\"]\n")),
            "");
}

// mesh.config() puts the blocks of a test on line 9 and after.
TEST(MeshScene, NamesThatTheMeshLacksAreFoundInTheDeck) {
  const MeshFile mesh(oneBrick({2, 2, 3}), addNodeSets);
  const std::string fault = faultOf(mesh.config("[[boundary.fixed]]\nnode_set = \"lft\"\n"
                                                "[[load.pressure]]\nside_set = \"frnt\"\n"
                                                "peak = 1.0\nshape = \"step\"\n"
                                                "[[initial.velocity]]\nblock = \"bric\"\n"
                                                "velocity = [1, 0, 0]\n"));
  for (const char* part :
       {"deck.toml:9: [[boundary.fixed]]: found no node set 'lft' in the mesh, expected one of "
        "left, front_nodes, nothing; did you mean 'left'?",
        "deck.toml:11: [[load.pressure]]: found no side set 'frnt' in the mesh, expected one of ",
        "deck.toml:15: [[initial.velocity]]: found no element block 'bric' in the mesh, expected "
        "one of brick; did you mean 'brick'?"})
    EXPECT_NE(fault.find(part), std::string::npos) << fault;
  EXPECT_EQ(
      faultOf(mesh.config("[[initial.deformation]]\nbody = 1\n"
                          "gradient = [0, 0, 0, 0, 0, 0, 0, 0, 0]\n")),
      "deck.toml:9: [[initial.deformation]] body: found the integer 1, expected at most 0, the "
      "number of the last body");
}

TEST(MeshScene, MaterialsOfBlocksThatTheMeshLacksAreRefused) {
  const MeshFile mesh(oneBrick({2, 2, 3}), [](io::MeshPart&) {});
  const std::string values = "density = 1.0\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\n";
  EXPECT_EQ(faultOf(mesh.config("[material.brck]\n" + values + "[material.stone]\n" + values)),
            "deck.toml:9: [material.brck]: found no element block 'brck' in the mesh, expected one "
            "of brick; did you mean 'brick'?\n"
            "deck.toml:13: [material.stone]: found no element block 'stone' in the mesh, expected "
            "one of brick");
  EXPECT_EQ(faultOf(mesh.config("")), "");
}

TEST(MeshScene, BlocksWithoutMaterialAreNamedAsADeckMustWriteThem) {
  const MeshFile mesh(oneBrick({2, 2, 3}),
                      [](io::MeshPart& part) { part.blocks[0].name = "upper \"half\""; });
  const std::string fault = faultOf(mesh.config(""));
  EXPECT_NE(fault.find("expected a table [material.\"upper \\\"half\\\"\"]"), std::string::npos)
      << fault;
}

TEST(MeshScene, MaterialsAndVelocitiesOfEmptyBlocksCauseWarnings) {
  const MeshFile mesh(oneBrick({2, 2, 3}), [](io::MeshPart& part) {
    part.blocks.push_back({2, "void", 0});
  });
  const Scene scene = makeScene(
      exec_space(), MPI_COMM_WORLD,
      mesh.config("[material.void]\ndensity = 1.0\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\n"
                  "[[initial.velocity]]\nblock = \"void\"\nvelocity = [1, 0, 0]\n"));
  ASSERT_EQ(scene.warnings.size(), 2u);
  EXPECT_NE(scene.warnings[0].find("[material.void] has no effect"), std::string::npos);
  EXPECT_NE(scene.warnings[1].find("[[initial.velocity]] has no effect"), std::string::npos);
  EXPECT_EQ(faultOf(mesh.config("")), ""); // it needs no material
}

TEST(MeshScene, PressureInsideABodyCausesAWarning) {
  const MeshFile mesh(oneBrick({3, 3, 3}), [](io::MeshPart& part) {
    part.side_sets.push_back(sidesOfTheCentralElement());
    part.side_sets.back().elems.push_back(14); // beside it, on the surface
    part.side_sets.back().sides.push_back(1);
  });
  const auto warningsOf = [&](const std::string& side_set) {
    return makeScene(exec_space(), MPI_COMM_WORLD,
                     mesh.config("[[load.pressure]]\nside_set = \"" + side_set +
                                 "\"\npeak = 1e-3\nshape = \"step\"\n"))
        .warnings;
  };
  const auto warnings = warningsOf("inner");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("2 of the 3 faces of side set \"inner\""), std::string::npos)
      << warnings[0];
  EXPECT_TRUE(warningsOf("front").empty());
}

TEST(MeshScene, EmptySetsCauseWarnings) {
  const MeshFile mesh(oneBrick({2, 2, 3}), addNodeSets);
  const Scene scene =
      makeScene(exec_space(), MPI_COMM_WORLD,
                mesh.config("[[boundary.fixed]]\nnode_set = \"nothing\"\n"
                            "[[boundary.fixed]]\nnode_set = \"left\"\ncomponents = [\"x\"]\n"));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("node set \"nothing\""), std::string::npos);
}

// Doubles near 2^20 have the spacing 2^-32, those near 2^40 2^-12; edges are about 1 long.
TEST(MeshScene, CoarseCoordinatesCauseAWarning) {
  const auto warningsAt = [](double place) {
    const MeshFile mesh(oneBrick({1, 1, 1}), [&](io::MeshPart& part) {
      for (double& x : part.coordinates)
        x += place;
    });
    return makeScene(exec_space(), MPI_COMM_WORLD, mesh.config("")).warnings;
  };
  EXPECT_TRUE(warningsAt(0x1p20).empty());
  const auto warnings = warningsAt(0x1p40);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("coordinates of up to 1.1e+12 are rounded to about 0.00024, "),
            std::string::npos)
      << warnings[0];
}

// Two bricks in two blocks, the second one `stiffer` times as stiff. Forces are rounded to between
// 2^-54 and 2^-53 of the force of the stiff block.
std::vector<std::string> warningsOfContrast(double stiffer) {
  io::WallConfig wall = oneBrick({2, 2, 2});
  wall.bricks = {2, 1, 1};
  io::MeshPart part = io::generateWall(MPI_COMM_WORLD, wall);
  part.blocks[0].name = "soft";
  part.blocks.push_back({2, "stiff", 8});
  for (int elem = 0; elem < part.numElems(); ++elem)
    part.elem_block[elem] = part.elem_body[elem] == 1;
  const mechanics::Material soft = {mechanics::MaterialModel::neo_hookean, 1, 1, 0.2};
  const mechanics::Material stiff = {mechanics::MaterialModel::neo_hookean, 1, stiffer, 0.2};
  return checkForceRange(MPI_COMM_WORLD, part, {soft, stiff});
}

TEST(MeshScene, ForcesTooCoarseForASoftBlockCauseAWarningOrAnError) {
  const double limit = coarse_forces * std::ldexp(1.0, 53),
               refused = too_coarse_forces * std::ldexp(1.0, 53);
  EXPECT_TRUE(warningsOfContrast(0.99 * limit).empty());
  const auto warnings = warningsOfContrast(2.01 * limit);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("element block 'soft'"), std::string::npos) << warnings[0];
  EXPECT_EQ(warningsOfContrast(0.99 * refused).size(), 1u);
  EXPECT_THROW(warningsOfContrast(2.01 * refused), InputError);
}

TEST(MeshScene, AnEdgeOfZeroLengthIsReportedWithFileAndElement) {
  const MeshFile mesh(
      oneBrick({2, 1, 1}), [](io::MeshPart& part) { // collapses an edge of the second element
        const auto node = [&](int corner) { return 3 * part.elem_nodes[8 + corner]; };
        for (const int corner : {2, 6}) // moved onto the neighbour along y
          for (int d = 0; d < 3; ++d)
            part.coordinates[node(corner) + d] = part.coordinates[node(corner - 1) + d];
        part.elem_numbers = {41, 71};
      });
  const std::string fault = faultOf(mesh.config(""));
  EXPECT_NE(fault.find(mesh.path() + ": "), std::string::npos) << fault;
  EXPECT_NE(fault.find("of the element with id 71 in elem_num_map"), std::string::npos) << fault;
}

TEST(MeshScene, AnInvertedElementIsReportedWithFileAndItsIdThere) {
  const MeshFile mesh(oneBrick({2, 1, 1}), [](io::MeshPart& part) {
    for (int corner = 0; corner < 4; ++corner) // bottom and top of the second element
      std::swap(part.elem_nodes[8 + corner], part.elem_nodes[12 + corner]);
    part.elem_numbers = {41, 71};
  });
  const std::string fault = faultOf(mesh.config(""));
  EXPECT_NE(fault.find(mesh.path() + ": element 1 (id 71 in elem_num_map) at ("), std::string::npos)
      << fault;
  EXPECT_NE(fault.find("inverted (J <= 0)"), std::string::npos) << fault;
}

TEST(MeshScene, AnElementWithOneCornerEightTimesIsReportedWithFileAndItsIdThere) {
  const MeshFile mesh(oneBrick({2, 1, 1}), [](io::MeshPart& part) {
    for (int corner = 1; corner < 8; ++corner)
      part.elem_nodes[8 + corner] = part.elem_nodes[8];
  });
  const std::string fault = faultOf(mesh.config(""));
  EXPECT_NE(fault.find(mesh.path() + ": the element of 1-based id 2"), std::string::npos) << fault;
}

TEST(MeshScene, ASideOfThreeElementsIsReportedWithFileAndElement) {
  const MeshFile mesh(oneBrick({3, 1, 1}),
                      [](io::MeshPart& part) { // the third begins where the second does
                        for (const int corner : {0, 3, 4, 7})
                          part.elem_nodes[16 + corner] = part.elem_nodes[8 + corner];
                        part.elem_numbers = {41, 71, 51};
                      });
  const std::string fault = faultOf(mesh.config(""));
  EXPECT_NE(fault.find(mesh.path() + ": element 0 (id 41 in elem_num_map) has a side that"),
            std::string::npos)
      << fault;
}

TEST(MeshScene, AStepThatIsNotRepresentableIsAnInputError) {
  const MeshFile mesh(oneBrick({2, 1, 1}), [](io::MeshPart&) {});
  Config config = mesh.config("");
  config.materials[0].material.density = 1e-300;
  config.time.end = 1e200;
  EXPECT_NE(faultOf(config).find("the stable step is "), std::string::npos);
}

// Turns the bricks of a course into rhombic wedges around the z axis, with their tops at z = 0, and
// the last one into a block over all of their points, 0.001 above them.
void makeWedges(io::MeshPart& part) {
  const auto num_wedges = static_cast<int>(part.num_global_bodies) - 1;
  std::vector<int> body(part.node_ids.size());
  for (std::size_t i = 0; i < part.elem_nodes.size(); ++i)
    body[part.elem_nodes[i]] = static_cast<int>(part.elem_body[i / 8]);
  for (int node = 0; node < part.numNodes(); ++node) {
    double* x = &part.coordinates[3 * node];
    const double along = x[0] - body[node], across = x[1];
    if (body[node] == num_wedges) {
      x[0] = along - 0.5, x[1] = across - 0.5, x[2] += 0.001;
      continue;
    }
    const double angle = 2 * std::acos(-1.0) / num_wedges, first = body[node] * angle;
    x[0] = along * std::cos(first) + across * std::cos(first + angle);
    x[1] = along * std::sin(first) + across * std::sin(first + angle);
    x[2] -= 1;
  }
}

TEST(MeshScene, ABlockFallsOntoThePointOfManyWedgesWithTheSameBitsOnAnyNumberOfRanks) {
  for (const int num_wedges : {12, 40}) {
    io::WallConfig course;
    course.bricks = {num_wedges + 1, 1, 1};
    course.brick = {1, 1, 1};
    course.elements = {2, 2, 1};
    const MeshFile mesh(course, makeWedges);
    const Config config = mesh.config("[[initial.velocity]]\nbody = " + std::to_string(num_wedges) +
                                      "\nvelocity = [0, 0, -0.01]\n");
    std::vector<Checksums> alone;
    for (const MPI_Comm comm : {MPI_COMM_SELF, MPI_COMM_WORLD}) {
      const Scene scene = makeScene(exec_space(), comm, config);
      Simulation simulation(comm, config, scene);
      simulation.start();
      int most_bodies = 0;
      for (int step = 0; step < 60; ++step) {
        simulation.step();
        const auto status = Kokkos::create_mirror_view_and_copy(
            Kokkos::HostSpace(), simulation.contact()->enforcement().status());
        for (std::size_t node = 0; node < status.extent(0); ++node)
          most_bodies = std::max(most_bodies, status(node));
        if (comm == MPI_COMM_SELF)
          alone.push_back(checksums(simulation));
        else {
          const Checksums found = checksums(simulation);
          ASSERT_EQ(found.nodes, alone[step].nodes) << step;
          ASSERT_EQ(found.contacts, alone[step].contacts) << step;
          ASSERT_EQ(found.interactions, alone[step].interactions) << step;
        }
      }
      EXPECT_EQ(allReduce(comm, most_bodies, MPI_MAX), num_wedges);
      EXPECT_GT(alone.back().interactions, 0);
    }
  }
}

} // namespace
} // namespace brickwall::miniapp::testing
