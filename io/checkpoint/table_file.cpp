#include "io/checkpoint/table_file.hpp"

#include "contact/base/error.hpp"
#include "contact/base/hash.hpp"
#include "io/exodus/exodus_file.hpp"

#include <netcdf.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace brickwall::io {
namespace {

// An open netCDF file, closed by its destructor; every call on it goes through check().
class NetcdfFile {
public:
  NetcdfFile(const std::string& path, bool writes) : _path(path), _writes(writes) {
    prepareLibraries();
    check(writes ? nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &_id)
                 : nc_open(path.c_str(), NC_NOWRITE, &_id));
    _is_open = true;
  }
  ~NetcdfFile() {
    if (_is_open)
      nc_close(_id);
  }
  NetcdfFile(const NetcdfFile&) = delete;
  NetcdfFile& operator=(const NetcdfFile&) = delete;

  int id() const { return _id; }
  void check(int code) const {
    if (code == NC_NOERR)
      return;
    const std::string reason = nc_strerror(code);
    if (_writes)
      throw OutputError(_path + ": could not be written: " + reason);
    throw InputError(_path + ": could not be read: " + reason);
  }
  void close() {
    _is_open = false;
    check(nc_close(_id));
  }

private:
  std::string _path;
  bool _writes, _is_open = false;
  int _id = -1;
};

// A length of 0 would make a fixed dimension unlimited; an unlimited one may stay empty.
int defineRows(const NetcdfFile& file, const Table& table) {
  const Column& first = table.columns.front();
  const std::size_t rows = first.words.size() / static_cast<std::size_t>(first.width);
  int dimension = -1;
  file.check(nc_def_dim(file.id(), table.name.c_str(), rows > 0 ? rows : NC_UNLIMITED, &dimension));
  return dimension;
}

} // namespace

const Column& Table::column(const std::string& wanted) const {
  for (const Column& column : columns)
    if (column.name == wanted)
      return column;
  throw InputError("the checkpoint has no column " + name + "_" + wanted);
}

void writeTables(const std::string& path, const std::vector<Table>& tables) {
  NetcdfFile file(path, true);
  std::vector<int> variables;
  for (const Table& table : tables) {
    const int rows = defineRows(file, table);
    for (const Column& column : table.columns) {
      const std::string name = table.name + "_" + column.name;
      int dimensions[2] = {rows, -1}, variable = -1;
      if (column.width > 1)
        file.check(nc_def_dim(file.id(), (name + "_width").c_str(),
                              static_cast<std::size_t>(column.width), &dimensions[1]));
      file.check(nc_def_var(file.id(), name.c_str(), column.is_real ? NC_DOUBLE : NC_INT64,
                            column.width > 1 ? 2 : 1, dimensions, &variable));
      variables.push_back(variable);
    }
  }
  file.check(nc_enddef(file.id()));
  std::size_t next = 0;
  for (const Table& table : tables)
    for (const Column& column : table.columns) {
      const int variable = variables[next++];
      if (!column.words.empty())
        file.check(nc_put_var(file.id(), variable, column.words.data()));
    }
  file.close();
  syncToDisk(path);
}

std::vector<Table> readTables(const std::string& path) {
  const NetcdfFile file(path, false);
  // Values are stored as they are: together they cannot have more bytes than the file.
  std::size_t words_left = std::filesystem::file_size(path) / 8;
  std::vector<Table> tables;
  int num_variables = 0;
  file.check(nc_inq_nvars(file.id(), &num_variables));
  for (int variable = 0; variable < num_variables; ++variable) {
    char name[NC_MAX_NAME + 1], rows_name[NC_MAX_NAME + 1];
    nc_type type = NC_NAT;
    int num_dimensions = 0, dimensions[NC_MAX_VAR_DIMS];
    file.check(nc_inq_var(file.id(), variable, name, &type, &num_dimensions, dimensions, nullptr));
    std::size_t rows = 0, width = 1;
    const bool is_column =
        (type == NC_INT64 || type == NC_DOUBLE) && (num_dimensions == 1 || num_dimensions == 2);
    if (is_column)
      file.check(nc_inq_dim(file.id(), dimensions[0], rows_name, &rows));
    if (is_column && num_dimensions == 2)
      file.check(nc_inq_dimlen(file.id(), dimensions[1], &width));
    const std::string prefix = std::string(is_column ? rows_name : "") + "_";
    if (!is_column || width < 1 || width > INT_MAX || rows > words_left / width ||
        std::string(name).compare(0, prefix.size(), prefix) != 0)
      throw InputError(path + ": " + name +
                       " is no column of a table: it has another name, type, " +
                       "or number of dimensions, or more values than the file can hold");
    words_left -= rows * width;
    if (tables.empty() || tables.back().name != rows_name)
      tables.push_back({rows_name, {}});
    Column column{name + prefix.size(), type == NC_DOUBLE, static_cast<int>(width),
                  std::vector<std::int64_t>(rows * width)};
    if (!column.words.empty())
      file.check(nc_get_var(file.id(), variable, column.words.data()));
    tables.back().columns.push_back(std::move(column));
  }
  return tables;
}

void syncToDisk(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_synced = descriptor >= 0 && fsync(descriptor) == 0;
  const std::string reason = std::strerror(errno);
  if (descriptor >= 0)
    close(descriptor);
  if (!is_synced)
    throw OutputError(path + ": could not be brought to the disk: " + reason);
}

std::uint64_t fileChecksum(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file)
    throw InputError(path + ": could not be read: " + std::strerror(errno));
  Hash hash;
  std::vector<std::uint64_t> block(std::size_t(1) << 17);
  std::uint64_t length = 0;
  while (true) {
    const std::size_t bytes = std::fread(block.data(), 1, 8 * block.size(), file.get());
    if (bytes == 0)
      break;
    length += bytes;
    if (bytes % 8 != 0) // only at the end of the file
      std::memset(reinterpret_cast<char*>(block.data()) + bytes, 0, 8 - bytes % 8);
    for (std::size_t i = 0; i < (bytes + 7) / 8; ++i)
      hash.take(block[i]);
  }
  if (std::ferror(file.get()) != 0)
    throw InputError(path + ": could not be read: " + std::strerror(errno));
  hash.take(length);
  return hash.value();
}

} // namespace brickwall::io
