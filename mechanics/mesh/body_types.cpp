#include "mechanics/mesh/body_types.hpp"

#include "contact/base/group_by_key.hpp"
#include "contact/base/hash.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/mesh/combine_by_body.hpp"
#include "mechanics/mesh/host_mesh.hpp"

#include <algorithm>
#include <set>

namespace brickwall::mechanics {

namespace {

// Lowest global ids of a body and the size of its elements.
struct BodyOrigin {
  global_id body = -1, elem = INT64_MAX, node = INT64_MAX;
  double longest_edge = 0;
};
// Sum of the hashes of a body's elements; it does not depend on their order.
struct BodyHash {
  global_id body = -1;
  std::uint64_t sum = 0;
};
// The lowest body of a type. `body` holds the hash, so that combineByBody brings bodies with equal
// hashes together.
struct TypeOfBody {
  global_id body = -1;
  global_id lowest = -1;
};

BodyOrigin originOf(const HostMesh& host, const ElementRange& body) {
  BodyOrigin origin;
  origin.body = body.body;
  for (int elem = body.first; elem < body.first + body.count; ++elem) {
    CornerCoordinates X;
    gatherCorners(host.elem_to_nodes, host.reference_coordinates, elem, X);
    origin.longest_edge = std::max(origin.longest_edge, longestEdge(X));
    origin.elem = std::min(origin.elem, host.elem_ids(elem));
    for (int c = 0; c < 8; ++c)
      origin.node = std::min(origin.node, host.node_ids(host.elem_to_nodes(elem, c)));
  }
  return origin;
}

std::uint64_t hashOf(const HostMesh& host, int elem, const BodyOrigin& origin) {
  Hash hash;
  const Material& material = host.materials(host.elem_block(elem));
  hash.take(material.density);
  hash.take(material.youngs);
  hash.take(material.poisson);
  hash.take(host.elem_ids(elem) - origin.elem);
  CornerCoordinates X;
  gatherCorners(host.elem_to_nodes, host.reference_coordinates, elem, X);
  for (int c = 0; c < 8; ++c)
    hash.take(host.node_ids(host.elem_to_nodes(elem, c)) - origin.node);
  // slightly above the edge, so that copies with an edge of a power of two agree
  const int exponent = std::ilogb(1.001 * origin.longest_edge);
  hash.take(std::int64_t(exponent));
  const double units = std::ldexp(1.0, 24 - exponent);
  for (int c = 1; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      hash.take(static_cast<std::int64_t>(std::rint((X[c][j] - X[0][j]) * units)));
  return hash.value();
}

} // namespace

BodyTypes findBodyTypes(const exec_space& space, MPI_Comm comm, const HexMesh& mesh) {
  const HostMesh host = copyToHost(space, mesh);
  const auto num_bodies = static_cast<std::int64_t>(mesh.bodies.size());
  std::vector<BodyOrigin> origins(mesh.bodies.size());
  parallelOnHost("mechanics::findBodyTypes::origins", num_bodies,
                 [&](std::int64_t b) { origins[b] = originOf(host, mesh.bodies[b]); });
  origins = combineByBody(comm, origins, [](BodyOrigin& a, const BodyOrigin& b) {
    a.elem = std::min(a.elem, b.elem);
    a.node = std::min(a.node, b.node);
    a.longest_edge = std::max(a.longest_edge, b.longest_edge);
  });

  std::vector<BodyHash> hashes(mesh.bodies.size());
  parallelOnHost("mechanics::findBodyTypes::hashes", num_bodies, [&](std::int64_t b) {
    const ElementRange& body = mesh.bodies[b];
    BodyHash hash{body.body, 0};
    for (int elem = body.first; elem < body.first + body.count; ++elem)
      hash.sum += hashOf(host, elem, origins[b]);
    hashes[b] = hash;
  });
  hashes = combineByBody(comm, hashes, [](BodyHash& a, const BodyHash& b) { a.sum += b.sum; });

  std::vector<TypeOfBody> types;
  for (const BodyHash& hash : hashes)
    types.push_back({static_cast<global_id>(hash.sum >> 1), hash.body});
  types = combineByBody(comm, types, [](TypeOfBody& a, const TypeOfBody& b) {
    a.lowest = std::min(a.lowest, b.lowest);
  });

  BodyTypes result;
  // The first node of a cut body may be on several ranks; only its owner counts the type.
  const auto is_owned = toHost(mesh.node_is_owned);
  std::set<global_id> counted; // a body may have several ranges of elements
  for (std::size_t b = 0; b < mesh.bodies.size(); ++b) {
    const ElementRange& body = mesh.bodies[b];
    result.representative.push_back(types[b].lowest);
    result.first_node.push_back(origins[b].node);
    if (types[b].lowest != body.body)
      continue;
    bool owns_first = false;
    for (int elem = body.first; elem < body.first + body.count; ++elem)
      for (int c = 0; c < 8; ++c) {
        const int node = host.elem_to_nodes(elem, c);
        owns_first = owns_first || (host.node_ids(node) == origins[b].node && is_owned(node));
      }
    result.count += owns_first && counted.insert(body.body).second;
  }
  result.count = allReduce(comm, result.count, MPI_SUM);
  return result;
}

} // namespace brickwall::mechanics
