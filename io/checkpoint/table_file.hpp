// Tables of numbers in a netCDF-4 file, which h5dump, ncdump and Python's netCDF4 open: one
// dimension for the rows of each table, one variable TABLE_COLUMN for each column.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace brickwall::io {

inline std::int64_t wordOf(double value) {
  std::int64_t word;
  std::memcpy(&word, &value, sizeof word);
  return word;
}
inline double realOf(std::int64_t word) {
  double value;
  std::memcpy(&value, &word, sizeof value);
  return value;
}

// A column of a table: rows of `width` integers, or of doubles by their bits.
struct Column {
  std::string name;
  bool is_real = false;
  int width = 1;
  std::vector<std::int64_t> words; // [row][width]
};

struct Table {
  std::string name;
  std::vector<Column> columns; // of equally many rows

  // Throws InputError if there is none.
  const Column& column(const std::string& name) const;
};

// Writes a file of this rank, closes it and waits until it is on the disk. Throws OutputError
// naming the file.
void writeTables(const std::string& path, const std::vector<Table>& tables);
// All tables of the file. Throws InputError naming the file.
std::vector<Table> readTables(const std::string& path);

// Waits until a file, or the names in a folder, are on the disk. Throws OutputError.
void syncToDisk(const std::string& path);
// A 64-bit hash of all bytes of a file and of their number. Throws InputError if it cannot be read.
std::uint64_t fileChecksum(const std::string& path);

} // namespace brickwall::io
