// The Exodus steps that a run writes.
#pragma once

#include "io/exodus/results_writer.hpp"
#include "miniapp/simulation/simulation.hpp"

#include <string>
#include <vector>

namespace brickwall::miniapp {

class Results {
public:
  // Creates `base`.exo (or this rank's file of it). Collective. Throws OutputError on all ranks.
  Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene);

  // Appends the present state. Collective. Throws OutputError on all ranks.
  void writeStep(Simulation& simulation);
  void close() { _writer.close(); }

private:
  void fillNodal(Simulation& simulation);
  void fillContact(const Simulation& simulation);
  void fillElement(Simulation& simulation);

  exec_space _space;
  const Scene& _scene;
  mechanics::SharedNodeSum _shared;
  io::ResultsWriter _writer;
  std::vector<std::vector<double>> _nodal, _element;
  mechanics::ElementFields _fields;
  View<std::int64_t**> _contact_words; // [node] status, bits of the gap; from owners to sharers
};

} // namespace brickwall::miniapp
