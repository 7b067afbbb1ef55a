#include "mechanics/mesh/congruent_bodies.hpp"

#include "contact/base/group_by_key.hpp"
#include "contact/base/mpi.hpp"
#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/mesh/combine_by_body.hpp"
#include "mechanics/mesh/host_mesh.hpp"

#include <algorithm>
#include <limits>

namespace brickwall::mechanics {

namespace {

// The element of lowest global id of a body, on one rank or on all.
struct Reference {
  global_id body = -1, elem = -1;
  double jacobian[3][3];
  double longest_edge = 0;
  std::int64_t block = 0;
};

Reference localReference(const HostMesh& host, const ElementRange& body) {
  int first = body.first;
  for (int elem = body.first; elem < body.first + body.count; ++elem)
    if (host.elem_ids(elem) < host.elem_ids(first))
      first = elem;
  Reference reference;
  reference.body = body.body;
  if (body.count == 0)
    return reference;
  CornerCoordinates X;
  gatherCorners(host.elem_to_nodes, host.reference_coordinates, first, X);
  double modes[3][num_modes];
  coordinateModes(X, modes);
  const Mat3 jacobian = centreJacobian(modes);
  reference.elem = host.elem_ids(first);
  for (int k = 0; k < 9; ++k)
    reference.jacobian[k / 3][k % 3] = jacobian(k / 3, k % 3);
  reference.longest_edge = longestEdge(X);
  reference.block = host.elem_block(first);
  return reference;
}

// Whether every edge of X matches the edge of the reference parallelepiped. Depends on this element
// alone.
bool isCongruent(const CornerCoordinates& X, const Reference& reference) {
  double magnitude = 0;
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      magnitude = std::max(magnitude, std::fabs(X[c][j]));
  const double tolerance =
      1e-12 * reference.longest_edge + 8 * std::numeric_limits<double>::epsilon() * magnitude;
  for (int edge = 0; edge < num_hex_edges; ++edge) {
    int a, b;
    edgeCorners(edge, a, b);
    for (int j = 0; j < 3; ++j) {
      double expected = 0;
      for (int k = 0; k < 3; ++k)
        expected += reference.jacobian[j][k] * (cornerXi(b, k) - cornerXi(a, k));
      if (!(std::fabs(X[b][j] - X[a][j] - expected) <= tolerance))
        return false;
    }
  }
  return true;
}

struct Verdict {
  global_id body = -1;
  std::int64_t congruent = 1;
  std::int64_t ranges = 1; // of elements, over all ranks
};

} // namespace

std::vector<BodyShape> markCongruentBodies(const exec_space& space, MPI_Comm comm,
                                           const HexMesh& mesh) {
  const HostMesh host = copyToHost(space, mesh);
  std::vector<Reference> references;
  rethrowOnAllRanks(comm, [&] {
    for (const ElementRange& body : mesh.bodies) {
      if (body.body < 0 || body.count < 1)
        throw Error(ExitCode::internal, "markCongruentBodies: body number " +
                                            std::to_string(body.body) + " with " +
                                            std::to_string(body.count) +
                                            " elements; a number >= 0 and elements are needed");
      references.push_back(localReference(host, body));
    }
  });
  references = combineByBody(comm, references, [](Reference& a, const Reference& b) {
    if (b.elem < a.elem)
      a = b;
  });

  std::vector<Verdict> verdicts(mesh.bodies.size());
  parallelOnHost("mechanics::markCongruentBodies", verdicts.size(), [&](std::int64_t b) {
    const ElementRange& body = mesh.bodies[b];
    Verdict verdict{body.body, 1, 1};
    for (int elem = body.first; verdict.congruent && elem < body.first + body.count; ++elem) {
      CornerCoordinates X;
      gatherCorners(host.elem_to_nodes, host.reference_coordinates, elem, X);
      verdict.congruent =
          host.elem_block(elem) == references[b].block && isCongruent(X, references[b]);
    }
    verdicts[b] = verdict;
  });
  verdicts = combineByBody(comm, verdicts, [](Verdict& a, const Verdict& b) {
    a.congruent &= b.congruent;
    a.ranges += b.ranges;
  });

  std::vector<BodyShape> shapes(mesh.bodies.size());
  for (std::size_t b = 0; b < shapes.size(); ++b) {
    shapes[b].congruent = verdicts[b].congruent != 0;
    shapes[b].whole = verdicts[b].ranges == 1;
    for (int k = 0; k < 9; ++k)
      shapes[b].jacobian(k / 3, k % 3) = references[b].jacobian[k / 3][k % 3];
  }
  return shapes;
}

} // namespace brickwall::mechanics
