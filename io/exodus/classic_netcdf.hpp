// Size check of netCDF classic files (CDF-1, 64-bit offset, CDF-5): the library reads the missing
// part of a truncated file as zeros, without an error. Format: netCDF Classic Format Specification,
// Unidata.
#pragma once

#include <cstdint>
#include <string>

namespace brickwall::io {

// Least size in bytes of the classic file at `path` according to its header: the end of its last
// variable (and of its last record). 0 when the file is not of a classic format. Throws InputError
// when the file cannot be read or ends within its header.
std::int64_t classicFileBytes(const std::string& path);

// Throws InputError naming the file, when it is missing, empty, or shorter than its classic header
// says. HDF5 checks its own files when they are opened.
void checkNotTruncated(const std::string& path);

} // namespace brickwall::io
