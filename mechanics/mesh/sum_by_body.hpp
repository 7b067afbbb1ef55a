// Sums over the elements or nodes of each body, for set-up: chunks of items are summed on the
// device, and chunks of a body on all ranks are combined.
#pragma once

#include "contact/base/to_device.hpp"
#include "mechanics/mesh/combine_by_body.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

#include <string>
#include <vector>

namespace brickwall::mechanics {

// Consecutive items, elements or places in a list of nodes, of one row of HexMesh::bodies.
struct BodyChunk {
  static constexpr int size = 256;
  int first = 0, count = 0, row = 0;
};
inline void cut(int first, int count, int row, std::vector<BodyChunk>& chunks) {
  for (int done = 0; done < count; done += BodyChunk::size)
    chunks.push_back({first + done, minOf(+BodyChunk::size, count - done), row});
}

template <class Value, class Add>
struct AddChunks {
  View<const BodyChunk*> chunks;
  View<Value*> sums;
  Add add;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t c) const {
    Value sum;
    add(chunks(c), sum);
    sums(c) = sum;
  }
};

template <class Value>
struct OfBody {
  global_id body = -1;
  Value value;
};

// For each row of HexMesh::bodies the sum of add(chunk, Value&) over the chunks of its body on all
// ranks; it must not depend on their order. Collective.
template <class Value, class Add>
std::vector<Value> sumByBody(const exec_space& space, MPI_Comm comm, const std::string& label,
                             const HexMesh& mesh, const std::vector<BodyChunk>& chunks,
                             const Add& add) {
  View<Value*> sums(label + "_sums", chunks.size());
  Kokkos::parallel_for(
      label, rangePolicy(space, chunks.size()),
      AddChunks<Value, Add>{toDevice(space, label + "_chunks", chunks), sums, add});
  space.fence();
  const auto host = toHost(sums);
  std::vector<OfBody<Value>> values;
  for (const ElementRange& range : mesh.bodies)
    values.push_back({range.body, Value()});
  for (std::size_t c = 0; c < chunks.size(); ++c)
    values[chunks[c].row].value += host(c);
  values = combineByBody(comm, values,
                         [](OfBody<Value>& a, const OfBody<Value>& b) { a.value += b.value; });
  std::vector<Value> result;
  for (const OfBody<Value>& value : values)
    result.push_back(value.value);
  return result;
}

} // namespace brickwall::mechanics
