// Reads the header of a netCDF classic file as far as needed to know where the data ends.
#include "io/exodus/classic_netcdf.hpp"

#include "contact/base/error.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

namespace brickwall::io {

namespace {

InputError truncated(const std::string& path) {
  return InputError(path + ": the file is truncated: it ends within its header");
}

// A product of counts, or a sum of two such; beyond `most` the header is damaged. So no sum of
// three overflows.
constexpr std::int64_t most = std::int64_t(1) << 60;
std::int64_t checked(const std::string& path, std::int64_t bytes) {
  if (bytes < 0 || bytes > most)
    throw InputError(path + ": the file is damaged: its header has impossible counts or types");
  return bytes;
}
std::int64_t product(const std::string& path, std::int64_t a, std::int64_t b) {
  return checked(path, b > 0 && a > most / b ? -1 : a * b);
}

// Big-endian reader of the header.
class Header {
public:
  Header(const std::string& path, std::ifstream& in, int version)
      : _path(path), _in(in), _count_bytes(version == 5 ? 8 : 4),
        _offset_bytes(version == 1 ? 4 : 8) {}

  std::int64_t number(int bytes) {
    unsigned char raw[8] = {};
    if (!_in.read(reinterpret_cast<char*>(raw), bytes))
      throw truncated(_path);
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i)
      value = value << 8 | raw[i];
    return static_cast<std::int64_t>(value);
  }
  int tag() { return static_cast<int>(number(4)); }
  std::int64_t count() { return checked(_path, number(_count_bytes)); }
  std::int64_t offset() { return checked(_path, number(_offset_bytes)); }
  // 0 while a program still appends records.
  std::int64_t numRecords() {
    const std::int64_t num = number(_count_bytes);
    return num == (_count_bytes == 4 ? 0xffffffffll : -1) ? 0 : checked(_path, num);
  }
  void skipPadded(std::int64_t bytes) { _in.seekg(bytes + (4 - bytes % 4) % 4, std::ios::cur); }
  void skipName() { skipPadded(count()); }
  void skipPaddedSize() { number(_count_bytes); }
  const std::string& path() const { return _path; }

private:
  const std::string& _path;
  std::ifstream& _in;
  int _count_bytes, _offset_bytes;
};

// netCDF itself divides by the size of an unknown type, and by the length of a dimension.
std::int64_t typeBytes(const std::string& path, int type) {
  // byte, char, short, int, float, double and the unsigned and 64-bit types of CDF-5, from 1
  constexpr int bytes[12] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
  return checked(path, type >= 1 && type <= 11 ? bytes[type] : -1);
}

void skipAttributes(Header& header) {
  header.tag();
  const std::int64_t num = header.count();
  for (std::int64_t i = 0; i < num; ++i) {
    header.skipName();
    const std::int64_t bytes = typeBytes(header.path(), header.tag());
    header.skipPadded(product(header.path(), bytes, header.count()));
  }
}

struct Variable {
  std::int64_t begin = 0, bytes = 0; // of the whole, or of one record
  bool is_record = false;
};

std::vector<std::int64_t> readDimensions(Header& header) {
  header.tag();
  std::vector<std::int64_t> lengths;
  const std::int64_t num = header.count();
  for (std::int64_t i = 0; i < num; ++i) {
    header.skipName();
    lengths.push_back(header.count()); // 0: the record dimension
  }
  return lengths;
}

std::vector<Variable> readVariables(Header& header, const std::vector<std::int64_t>& lengths) {
  header.tag();
  std::vector<Variable> variables;
  const std::int64_t num = header.count();
  for (std::int64_t v = 0; v < num; ++v) {
    Variable variable;
    header.skipName();
    const std::int64_t num_dims = header.count();
    std::int64_t values = 1;
    for (std::int64_t d = 0; d < num_dims; ++d) {
      const std::int64_t dim = header.count();
      const bool is_known = dim < static_cast<std::int64_t>(lengths.size());
      const std::int64_t length = is_known ? lengths[static_cast<std::size_t>(dim)] : -1;
      if (d == 0 && length == 0)
        variable.is_record = true;
      else
        values = product(header.path(), values, checked(header.path(), length > 0 ? length : -1));
    }
    skipAttributes(header);
    variable.bytes = product(header.path(), values, typeBytes(header.path(), header.tag()));
    header.skipPaddedSize(); // too small a field for large variables
    variable.begin = header.offset();
    variables.push_back(variable);
  }
  return variables;
}

std::int64_t endOf(const std::string& path, const std::vector<Variable>& variables,
                   std::int64_t num_records) {
  const auto padded = [](std::int64_t bytes) { return (bytes + 3) / 4 * 4; };
  std::int64_t record_bytes = 0, num_record_variables = 0, only = 0;
  for (const Variable& v : variables)
    if (v.is_record) {
      record_bytes = checked(path, record_bytes + padded(v.bytes));
      ++num_record_variables;
      only = v.bytes;
    }
  if (num_record_variables == 1)
    record_bytes = only; // a single record variable is not padded
  std::int64_t end = 0;
  for (const Variable& v : variables) {
    if (v.is_record && num_records > 0)
      end = std::max(end, v.begin + product(path, num_records - 1, record_bytes) + v.bytes);
    else if (!v.is_record && v.bytes > 0)
      end = std::max(end, v.begin + v.bytes);
  }
  return end;
}

} // namespace

std::int64_t classicFileBytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  char magic[4] = {};
  if (!in.read(magic, 4))
    throw truncated(path);
  const int version = static_cast<unsigned char>(magic[3]);
  if (std::string(magic, 3) != "CDF" || (version != 1 && version != 2 && version != 5))
    return 0;
  Header header(path, in, version);
  const std::int64_t num_records = header.numRecords();
  const std::vector<std::int64_t> lengths = readDimensions(header);
  skipAttributes(header);
  return endOf(path, readVariables(header, lengths), num_records);
}

void checkNotTruncated(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (is_directory(status))
    throw InputError(path + ": is a folder, not a mesh file");
  if (exists(status) && !is_regular_file(status)) // reading from a pipe may never end
    throw InputError(path + ": is a pipe or a device, not a mesh file");
  const std::int64_t needed = classicFileBytes(path);
  const auto found = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  if (!error && found < needed)
    throw InputError(path + ": the file is truncated: it has " + std::to_string(found) +
                     " bytes, its header requires " + std::to_string(needed));
}

} // namespace brickwall::io
