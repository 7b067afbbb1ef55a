// The Exodus steps that a run writes.
#pragma once

#include "io/exodus/results_writer.hpp"
#include "miniapp/output/earlier_results.hpp"
#include "miniapp/simulation/simulation.hpp"
#include "miniapp/timing/phase_recorder.hpp"

#include <string>
#include <vector>

namespace brickwall::miniapp {

// The variables of the Exodus files, those of each field in the order of OutputField.
io::ResultsConfig resultsConfig(const Config& config);

// Each field is computed in output steps only, and only if the deck chooses it (output.fields).
class Results {
public:
  // Creates `base`.exo (or this rank's file of it). `recorder` knows the time of the searches and
  // must outlive the object. Collective. Throws OutputError on all ranks.
  Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene,
          const PhaseRecorder& recorder);
  // The same with the steps of an earlier run, whose files it replaces when all steps are copied.
  // Collective. Throws as EarlierResults::copyTo().
  Results(MPI_Comm comm, const std::string& base, const Config& config, const Scene& scene,
          const PhaseRecorder& recorder, const EarlierResults& earlier);

  // Appends the present state. Collective. Throws OutputError on all ranks.
  void writeStep(Simulation& simulation);
  void close() { _writer.close(); }
  int numSteps() const { return _writer.numSteps(); }
  const std::string& fileName() const { return _writer.fileName(); } // of this rank

private:
  Results(MPI_Comm comm, const std::string& base, const io::ResultsConfig& results,
          const Config& config, const Scene& scene, const PhaseRecorder& recorder);
  // The values [component][node or element] of a field that is computed here; null if it is not
  // chosen.
  std::vector<double>* valuesOf(OutputField field);
  void fillMotion(Simulation& simulation);
  void fillContact(Simulation& simulation);
  void fillStress(const Simulation& simulation);
  void fillSearch(Simulation& simulation);

  exec_space _space;
  const Scene& _scene;
  const PhaseRecorder& _recorder;
  mechanics::SharedNodeSum _shared;
  io::ResultsWriter _writer;
  std::vector<std::string> _nodal_names, _element_names;
  std::vector<std::vector<double>> _nodal, _element; // [variable][node or element]
  mechanics::ElementFields _fields;
  // [node] status, bits of the gap and of the slip velocity; from owners to sharers
  View<std::int64_t**> _contact_words;
};

} // namespace brickwall::miniapp
