// The Exodus steps that an earlier run wrote, on any number of ranks. A restarted run copies them
// to files of its own, so that its files are those of a run without interruption.
#pragma once

#include "io/exodus/results_reader.hpp"
#include "io/exodus/results_writer.hpp"

#include <mpi.h>

#include <string>
#include <vector>

namespace brickwall::miniapp {

class EarlierResults {
public:
  // Opens the files of `base`: those of `ranks` ranks, or else of any number of ranks, with at
  // least `steps` steps (0: none yet), the last of them at `time`. `reason` tells why none is
  // suitable; "" with files, or without any. Each rank reads its share of the files. Collective.
  EarlierResults(MPI_Comm comm, const std::string& base, int ranks, int steps, double time,
                 const io::ResultsConfig& config);

  bool isFound() const { return _ranks > 0; }
  const std::string& reason() const { return _reason; }

  // Appends all steps to `writer`, whose mesh is `part`. Collective. Throws as the writer, and
  // InputError on all ranks for a file that cannot be read.
  void copyTo(io::ResultsWriter& writer, const io::MeshPart& part) const;
  // The files of `writer`, which carry new_suffix, take the place of these once all are on the
  // disk. Collective. Throws OutputError on all ranks.
  void replaceBy(const io::ResultsWriter& writer) const;
  static constexpr const char* new_suffix = ".new";

  // Ends a replacement during which a run was killed: files that were complete on all ranks get
  // their names, others are removed. Collective. Throws OutputError on all ranks.
  static void endReplacement(MPI_Comm comm, const std::string& base);

private:
  std::string open(int ranks); // returns why these files are not suitable; collective
  std::string problemOf(const io::ResultsReader& file) const;

  MPI_Comm _comm;
  std::string _base, _reason;
  int _steps;
  double _time;
  std::vector<std::string> _nodal_names, _element_names, _global_names;
  int _ranks = 0; // that wrote the files; 0: none is found
  std::vector<io::ResultsReader> _files; // of this rank
};

} // namespace brickwall::miniapp
