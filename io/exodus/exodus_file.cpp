// Exodus handle and error check.
#include "io/exodus/exodus_file.hpp"

#include "contact/base/error.hpp"
#include "io/exodus/classic_netcdf.hpp"

#include <exodusII.h>
#include <netcdf.h>

#include <dlfcn.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

namespace brickwall::io {

namespace {

// The message of Exodus or netCDF for the last failure.
std::string reason() {
  const char* message = "";
  const char* function = "";
  int code = 0;
  ex_get_err(&message, &function, &code);
  const char* text = ex_strerror(code);
  return std::string(text != nullptr && *text != '\0' ? text : message) + " (" + function + ")";
}

// Whether the variables of an open file have more values than a file of that size can hold: deflate
// compresses 1032 times at best. A damaged length would be allocated otherwise.
bool hasTooManyValues(int id, double file_bytes) {
  int num_variables = 0;
  nc_inq_nvars(id, &num_variables);
  for (int variable = 0; variable < num_variables; ++variable) {
    int num_dimensions = 0, dimensions[NC_MAX_VAR_DIMS];
    nc_inq_var(id, variable, nullptr, nullptr, &num_dimensions, dimensions, nullptr);
    double values = 1;
    for (int d = 0; d < num_dimensions; ++d) {
      std::size_t length = 0;
      nc_inq_dimlen(id, dimensions[d], &length);
      values *= static_cast<double>(length);
    }
    if (values > 1032 * file_bytes)
      return true;
  }
  return false;
}

// ex_open writes to standard error when it fails, whatever its options are: netCDF opens the file
// first.
void checkIsExodus(const std::string& path) {
  int id = -1;
  int code = nc_open(path.c_str(), NC_NOWRITE, &id);
  bool is_possible = true;
  if (code == NC_NOERR) {
    float version = 0;
    code = nc_get_att_float(id, NC_GLOBAL, "version", &version);
    is_possible = !hasTooManyValues(id, static_cast<double>(std::filesystem::file_size(path)));
    nc_close(id);
  }
  if (!is_possible)
    throw InputError(path + ": is damaged: it names more values than a file of its size can hold");
  if (code != NC_NOERR)
    throw InputError(path + ": is not an Exodus file, or is damaged: " + nc_strerror(code));
}

} // namespace

// The exit handler of HDF5 crashes when a netCDF-4 file could
// not be flushed to a full disk, so that the exit code would be lost. This must precede the first
// use of HDF5; no handle is found when the netCDF library was built without HDF5.
void prepareLibraries() {
  static const bool prepared = [] {
    using Function = int (*)();
    if (const auto without_exit_handler =
            reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, "H5dont_atexit")))
      without_exit_handler();
    return true;
  }();
  (void)prepared;
  ex_opts(0);
}

ExodusFile ExodusFile::create(const std::string& path, int flags, int stored_real_bytes) {
  prepareLibraries();
  int computed_real_bytes = 8;
  const int id = ex_create(path.c_str(), flags, &computed_real_bytes, &stored_real_bytes);
  if (id < 0) {
    // errno of ex_create() may be that of a later call
    std::FILE* const plain = std::fopen(path.c_str(), "ab");
    const std::string why = plain == nullptr ? std::string(std::strerror(errno)) : reason();
    if (plain != nullptr)
      std::fclose(plain);
    throw OutputError(path + ": cannot be created: " + why);
  }
  return ExodusFile(path, id, true);
}

ExodusFile ExodusFile::open(const std::string& path) {
  checkNotTruncated(path);
  prepareLibraries();
  checkIsExodus(path);
  int computed_real_bytes = 8, stored_real_bytes = 0;
  float version = 0;
  const int id = ex_open(path.c_str(), EX_READ | EX_ALL_INT64_API, &computed_real_bytes,
                         &stored_real_bytes, &version);
  if (id < 0)
    throw InputError(path + ": is not an Exodus file, or is damaged: " + reason());
  return ExodusFile(path, id, false);
}

ExodusFile::~ExodusFile() {
  if (_id >= 0)
    ex_close(_id);
}
ExodusFile::ExodusFile(ExodusFile&& other) noexcept
    : _path(std::move(other._path)), _id(std::exchange(other._id, -1)), _writing(other._writing) {}
ExodusFile& ExodusFile::operator=(ExodusFile&& other) noexcept {
  std::swap(_path, other._path);
  std::swap(_id, other._id);
  std::swap(_writing, other._writing);
  return *this;
}

int ExodusFile::check(int returned, const std::string& what) const {
  if (returned >= 0)
    return returned;
  if (_writing)
    throw OutputError(_path + ": could not write " + what + ": " + reason());
  throw InputError(_path + ": could not read " + what + ": " + reason());
}

void ExodusFile::close() {
  if (_id >= 0)
    check(ex_close(std::exchange(_id, -1)), "the end of the file");
}

} // namespace brickwall::io
