#include "miniapp/output/history.hpp"

#include "contact/base/mpi.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

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

std::string headerOf(const std::vector<std::string>& columns) {
  std::string line;
  for (const std::string& column : columns)
    line += (line.empty() ? "" : ",") + column;
  return line;
}

// Bytes of the header and of the first `rows` rows; -1 if the file has another header or fewer
// rows.
std::int64_t bytesOfRows(const std::string& path, const std::string& header, std::int64_t rows) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || line != header)
    return -1;
  for (std::int64_t row = 0; row < rows; ++row)
    if (!std::getline(file, line) || file.eof()) // a torn last line has no end
      return -1;
  return file.tellg();
}

} // namespace

HistoryWriter::HistoryWriter(MPI_Comm comm, const std::string& path,
                             std::vector<std::string> columns)
    : _comm(comm), _path(path), _columns(std::move(columns)) {
  if (!_path.empty())
    open("w", "create");
}

HistoryWriter::HistoryWriter(MPI_Comm comm, const std::string& path,
                             std::vector<std::string> columns, std::int64_t rows)
    : _comm(comm), _path(path), _columns(std::move(columns)), _num_rows(rows) {
  rethrowOnAllRanks(_comm, [&] {
    if (rankOf(_comm) != 0)
      return;
    std::error_code error;
    std::filesystem::resize_file(
        _path, static_cast<std::uintmax_t>(bytesOfRows(_path, headerOf(_columns), rows)), error);
    if (error)
      throw OutputError(_path + ": cannot be shortened: " + error.message());
  });
  open("a", "continue");
}

std::string HistoryWriter::whyNotContinued(MPI_Comm comm, const std::string& path,
                                           const std::vector<std::string>& columns,
                                           std::int64_t rows) {
  std::string reason;
  if (rankOf(comm) == 0 && bytesOfRows(path, headerOf(columns), rows) < 0)
    reason = path + ": expected the columns of this run and at least " + std::to_string(rows) +
             " rows, which were written before the checkpoint";
  return broadcast(comm, reason);
}

std::int64_t HistoryWriter::firstStep(MPI_Comm comm, const std::string& path) {
  std::int64_t step = std::numeric_limits<std::int64_t>::max();
  if (rankOf(comm) == 0) {
    std::ifstream file(path);
    std::string header;
    if (std::int64_t found = 0; std::getline(file, header) && file >> found)
      step = found;
  }
  broadcast(comm, &step, 1, 0);
  return step;
}

void HistoryWriter::open(const char* mode, const char* verb) {
  try {
    rethrowOnAllRanks(_comm, [&] {
      if (rankOf(_comm) != 0)
        return;
      _file = std::fopen(_path.c_str(), mode);
      if (!_file)
        throw OutputError(_path + ": cannot " + verb + " the history: " + std::strerror(errno));
      if (*mode == 'w')
        writeLine(_file, _path, headerOf(_columns));
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
  ++_num_rows;
}

} // namespace brickwall::miniapp
