#include "miniapp/scene/memory_estimate.hpp"

namespace brickwall::miniapp {

// The bytes of an entity are sums over the Views of the time loop.
MemoryEstimate estimateMemory(const SceneSize& size, int ranks, bool on_gpu) {
  const auto elements = static_cast<double>(size.elements);
  // Nine columns of forces, X, u and v, id, mass, prescribed motion, owner; contact fields of the
  // output. On a GPU the next displacement and whether contact may act.
  const double of_nodes = (9 * 8 + 3 * 24 + 8 + 8 + 3 + 1 + 2 * 8 + (on_gpu ? 24 + 1 : 0)) *
                          static_cast<double>(size.nodes);
  // Connectivity, id, block, chunk with its pack, share of the mass; the output's stresses,
  // pressure and energies with a reserve of a quarter; geometry.
  const double of_elements =
      (32 + 8 + 4 + 40 + 8 + 1.25 * 9 * 8 + (size.stores_geometry ? 370 : 0)) * elements;
  // Skin and load. With contact: coordinates, records, boxes, tree, lists of candidates and their
  // rows (650), the contacts of two steps with a reserve (0.8 of 604), and on a GPU the pairs that
  // the first step of pressed bricks tests (290), on a host the forces that threads add to the nodes
  // of others (24).
  const double of_contact = 650 + 0.8 * 604 + (on_gpu ? 290 : 24);
  const double of_faces =
      (82 + (size.has_contact ? of_contact : 0)) * static_cast<double>(size.faces);
  // Coordinates, records, boxes, lists and the bounds of sleeping rows, of which a GPU has more.
  const double of_edges =
      size.has_contact ? (on_gpu ? 2170 : 860) * static_cast<double>(size.edges) : 0;
  const double views = (of_nodes + of_elements + of_faces + of_edges) / ranks;
  // Measured: code and libraries with MPI and Kokkos; the context of CUDA with the local memory of
  // the largest kernel; and what the host holds beside the Views at the end of the set-up or, with
  // a GPU, while it writes output.
  const double program = 45e6, context = on_gpu ? 1.28e9 : 0;
  const double beside = (on_gpu ? 390 : 120) * elements / ranks;
  return {context + views, program + context + views + beside};
}

} // namespace brickwall::miniapp
