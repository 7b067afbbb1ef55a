// history.csv: one row per history interval, readable at any moment of the run, also after a kill.
#pragma once

#include <mpi.h>

#include <cstdio>
#include <string>
#include <vector>

namespace brickwall::miniapp {

class HistoryWriter {
public:
  // Collective: rank 0 creates the file and writes the header line; throws OutputError on every
  // rank when that fails. An empty path writes nothing.
  HistoryWriter(MPI_Comm comm, const std::string& path, std::vector<std::string> columns);
  ~HistoryWriter();
  HistoryWriter(const HistoryWriter&) = delete;
  HistoryWriter& operator=(const HistoryWriter&) = delete;

  // Collective; rank 0's values count, one for each column; each is printed so that it reads back
  // to the same bits (whole numbers without a point). The row is on the file when this returns;
  // else OutputError on every rank.
  void write(const std::vector<double>& values);

private:
  MPI_Comm _comm;
  std::string _path;
  std::vector<std::string> _columns;
  std::FILE* _file = nullptr;
};

} // namespace brickwall::miniapp
