// The Exodus reader on any bytes: a file is refused with a message, or is a sound mesh.
#include "tests/fuzz/mesh_properties.hpp"

#include <fstream>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brickwall::fuzz;
  const std::string path = folder() / "bytes.exo";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  if (const auto part = readOrRefuse(path)) {
    demandSound(*part);
    demandSameWhenWritten(*part);
  }
  return 0;
}
