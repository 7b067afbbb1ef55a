// One Exodus file, closed by its destructor, and the check that every Exodus call goes through.
#pragma once

#include <string>

namespace brickwall::io {

// Silences Exodus, and disables the exit handler of HDF5. Call before the first use of either.
void prepareLibraries();

// Owns an open Exodus id. Calls on it are written
//   file.check(ex_put_time(file.id(), step, &time), "time of step 3");
// and throw OutputError (a file being written) or InputError (a file being read) naming the file
// and the failed operation.
class ExodusFile {
public:
  // `flags` as of ex_create; bytes of a real in the file are 8 or 4. Throws OutputError.
  static ExodusFile create(const std::string& path, int flags, int stored_real_bytes);
  // Opens for reading with 64-bit integers and doubles. Throws InputError: missing, truncated or
  // not Exodus.
  static ExodusFile open(const std::string& path);

  ExodusFile() = default;
  ~ExodusFile();
  ExodusFile(ExodusFile&& other) noexcept;
  ExodusFile& operator=(ExodusFile&& other) noexcept;

  int id() const { return _id; }
  const std::string& path() const { return _path; }

  // Returns the result of an Exodus call; below 0, throws an error with the file, `what` and the
  // reason that Exodus gives.
  int check(int returned, const std::string& what) const;

  // Closes and checks: a full disk shows here at the latest.
  void close();

private:
  ExodusFile(const std::string& path, int id, bool writing)
      : _path(path), _id(id), _writing(writing) {}

  std::string _path;
  int _id = -1;
  bool _writing = false;
};

} // namespace brickwall::io
