// A simulation from the text of a deck, with sums over the nodes of a body.
#pragma once

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "miniapp/simulation/diagnostics.hpp"

#include <cstdio>
#include <string>

namespace brickwall::verification {

struct Case {
  explicit Case(const std::string& deck, MPI_Comm comm = MPI_COMM_WORLD)
      : config(miniapp::parseConfig(deck, "case.toml")),
        scene(miniapp::makeScene(exec_space(), comm, config)), simulation(comm, config, scene) {}

  miniapp::Config config;
  miniapp::Scene scene;
  miniapp::Simulation simulation;

  // Sum over the owned nodes of one body of value(node), over all ranks; `value` reads host copies.
  template <class Value>
  double sumOverBody(global_id body, const Value& value) const {
    double sum = 0;
    std::vector<char> counted(scene.part.node_ids.size(), 0);
    for (int elem = 0; elem < scene.part.numElems(); ++elem)
      if (scene.part.elem_body[elem] == body)
        for (int corner = 0; corner < 8; ++corner) {
          const int node = scene.part.elem_nodes[8 * elem + corner];
          if (!counted[node] && scene.node_is_owned[node])
            sum += value(node);
          counted[node] = 1;
        }
    return allReduce(MPI_COMM_WORLD, sum, MPI_SUM);
  }
  double momentum(global_id body, int component) const {
    const auto v = toHost(simulation.state().velocity);
    const auto mass = toHost(simulation.state().mass);
    return sumOverBody(body, [&](int node) { return mass(node) * v(node, component); });
  }
  // Displacement of the body's centre of mass.
  double meanDisplacement(global_id body, int component) const {
    const auto u = toHost(simulation.state().displacement);
    const auto mass = toHost(simulation.state().mass);
    return sumOverBody(body, [&](int node) { return mass(node) * u(node, component); }) /
           sumOverBody(body, [&](int node) { return mass(node); });
  }
};

inline void printResult(const char* name, double computed, double exact, double error,
                        double threshold) {
  if (rankOf(MPI_COMM_WORLD) == 0)
    std::printf("%s %s computed=%.8g exact=%.8g error=%.3g threshold=%.3g\n", name,
                error <= threshold ? "PASS" : "FAIL", computed, exact, error, threshold);
}

} // namespace brickwall::verification
