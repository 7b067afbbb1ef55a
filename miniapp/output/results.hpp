// The Exodus steps that a run writes.
#pragma once

#include "io/exodus/results_writer.hpp"
#include "miniapp/output/earlier_results.hpp"
#include "miniapp/simulation/simulation.hpp"

#include <string>
#include <vector>

namespace brickwall::miniapp {

// The variables of the Exodus files.
io::ResultsConfig resultsConfig(const Config& config);

class Results {
public:
  // Creates `base`.exo (or this rank's file of it). Collective. Throws OutputError on all ranks.
  Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene);
  // The same with the steps of an earlier run, whose files it replaces when all steps are copied.
  // Collective. Throws as EarlierResults::copyTo().
  Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene,
          const EarlierResults& earlier);

  // Appends the present state. Collective. Throws OutputError on all ranks.
  void writeStep(Simulation& simulation);
  void close() { _writer.close(); }
  int numSteps() const { return _writer.numSteps(); }
  const std::string& fileName() const { return _writer.fileName(); } // of this rank

private:
  Results(MPI_Comm comm, const std::string& base, const io::ResultsConfig& config,
          const Scene& scene);
  void fillNodal(Simulation& simulation);
  void fillContact(Simulation& simulation);
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
