// history.csv: one row per history interval. The file can be read at any time of the run, also
// after the run was killed.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace brickwall::miniapp {

class HistoryWriter {
public:
  // Collective: rank 0 creates the file and writes the header line; throws OutputError on every
  // rank when that fails. An empty path writes nothing.
  HistoryWriter(MPI_Comm comm, const std::string& path, std::vector<std::string> columns);
  // Continues the file of an earlier run after its first `rows` rows; the others are removed.
  // whyNotContinued() must be empty. Collective; throws as above.
  HistoryWriter(MPI_Comm comm, const std::string& path, std::vector<std::string> columns,
                std::int64_t rows);
  // Why the file cannot be continued after `rows` rows; "" if it can. Collective.
  static std::string whyNotContinued(MPI_Comm comm, const std::string& path,
                                     const std::vector<std::string>& columns, std::int64_t rows);
  // The step of the first row of a file, its first column; without rows the largest number.
  // Collective.
  static std::int64_t firstStep(MPI_Comm comm, const std::string& path);
  ~HistoryWriter();
  HistoryWriter(const HistoryWriter&) = delete;
  HistoryWriter& operator=(const HistoryWriter&) = delete;

  // Collective; the values of rank 0 count, one for each column. Each is printed so that it reads
  // back to the same bits (whole numbers without a point). The row is in the file when this
  // returns; throws OutputError on every rank when that fails.
  void write(const std::vector<double>& values);
  std::int64_t numRows() const { return _num_rows; }

private:
  void open(const char* mode, const char* verb);

  MPI_Comm _comm;
  std::string _path;
  std::vector<std::string> _columns;
  std::FILE* _file = nullptr;
  std::int64_t _num_rows = 0;
};

} // namespace brickwall::miniapp
