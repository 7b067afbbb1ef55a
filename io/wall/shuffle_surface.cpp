#include "io/wall/shuffle_surface.hpp"

#include "io/wall/hashed_random.hpp"

#include <algorithm>
#include <utility>

namespace brickwall::io {
namespace {

// order[new place] = old place: by the hashes of the ids, equal hashes by id.
std::vector<int> hashedOrder(std::uint64_t seed, const std::vector<global_id>& ids) {
  std::vector<std::pair<std::uint64_t, int>> keys;
  keys.reserve(ids.size());
  const std::uint64_t salt = mixBits(seed);
  for (const global_id id : ids)
    keys.emplace_back(mixBits(salt ^ static_cast<std::uint64_t>(id)),
                      static_cast<int>(keys.size()));
  std::sort(keys.begin(), keys.end());
  std::vector<int> order;
  order.reserve(keys.size());
  for (const auto& key : keys)
    order.push_back(key.second);
  return order;
}

// Rows of `width` values in the new order.
template <class T>
void permute(const std::vector<int>& order, std::size_t width, std::vector<T>& values) {
  std::vector<T> permuted;
  permuted.reserve(values.size());
  for (const int old : order)
    for (std::size_t w = 0; w < width; ++w)
      permuted.push_back(values[static_cast<std::size_t>(old) * width + w]);
  values.swap(permuted);
}

} // namespace

void shuffleSurface(std::uint64_t seed, SurfacePart& part) {
  const std::vector<int> nodes = hashedOrder(seed, part.node_ids);
  permute(nodes, 1, part.node_ids);
  permute(nodes, 3, part.coordinates);
  permute(nodes, 1, part.node_owner);
  permute(nodes, 1, part.node_body);
  std::vector<int> place(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    place[nodes[i]] = static_cast<int>(i);
  for (int& corner : part.face_nodes)
    corner = place[corner];

  const std::vector<int> faces = hashedOrder(seed + 1, part.face_ids);
  permute(faces, 1, part.face_ids);
  permute(faces, 4, part.face_nodes);
  permute(faces, 1, part.face_body);
}

} // namespace brickwall::io
