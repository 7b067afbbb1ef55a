#include "miniapp/output/history.hpp"

#include "contact/base/mpi.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

namespace brickwall::miniapp {
namespace {

// Shortest spelling that reads back to the same bits.
std::string spell(double value) {
  if (std::isnan(value))
    return "nan";
  char digits[32];
  return std::string(digits, std::to_chars(digits, digits + sizeof(digits), value).ptr);
}

void writeLine(std::FILE* file, const std::string& path, std::string line) {
  line += '\n';
  if (std::fwrite(line.data(), 1, line.size(), file) != line.size() || std::fflush(file) != 0)
    throw OutputError(path + ": cannot write the history: " + std::strerror(errno));
}

} // namespace

HistoryWriter::HistoryWriter(MPI_Comm comm, const std::string& path,
                             std::vector<std::string> columns)
    : _comm(comm), _path(path), _columns(std::move(columns)) {
  if (_path.empty())
    return;
  try {
    rethrowOnAllRanks(_comm, [&] {
      if (rankOf(_comm) != 0)
        return;
      _file = std::fopen(_path.c_str(), "w");
      if (!_file)
        throw OutputError(_path + ": cannot create the history: " + std::strerror(errno));
      std::string line;
      for (const std::string& column : _columns)
        line += (line.empty() ? "" : ",") + column;
      writeLine(_file, _path, line);
    });
  } catch (...) {
    if (_file)
      std::fclose(_file);
    throw;
  }
}

HistoryWriter::~HistoryWriter() {
  if (_file)
    std::fclose(_file); // every row is flushed already
}

void HistoryWriter::write(const std::vector<double>& values) {
  if (_path.empty())
    return;
  rethrowOnAllRanks(_comm, [&] {
    if (rankOf(_comm) != 0)
      return;
    if (values.size() != _columns.size())
      throw Error(ExitCode::internal, "HistoryWriter::write: found " +
                                          std::to_string(values.size()) + " values, expected " +
                                          std::to_string(_columns.size()));
    std::string line;
    for (const double value : values)
      line += (line.empty() ? "" : ",") + spell(value);
    writeLine(_file, _path, line);
  });
}

} // namespace brickwall::miniapp
