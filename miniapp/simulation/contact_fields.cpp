// Values of contact for output, on the mesh, wherever the faces are searched.
#include "contact/enforcement/reports/contact_fields.hpp"
#include "contact/base/to_device.hpp"
#include "miniapp/simulation/contact_step.hpp"

#include <unordered_map>

namespace brickwall::miniapp {

namespace {

struct FaceCount {
  global_id face;
  std::int64_t count;
};

} // namespace

void ContactStep::statusOnMesh(mechanics::SharedNodeSum& shared,
                               const View<std::int64_t**>& of_mesh) {
  const contact::Surface surface = _coupling.surface();
  const View<std::int64_t**> words("miniapp::ContactStep::status", surface.num_nodes,
                                   of_mesh.extent(1));
  const auto is_owned = surface.node_is_owned;
  const auto status = _enforcement->status();
  const auto gap = _enforcement->gap();
  const bool has_slip = of_mesh.extent(1) > 2 && _has_forces_of_search;
  View<double* [3]> slip;
  if (has_slip)
    slip = contact::slipMotion(_space, {surface, _search.ghosts()}, _enforcement->history());
  Kokkos::parallel_for(
      "miniapp::ContactStep::packStatus", rangePolicy(_space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        if (!is_owned(i)) // the sum then forwards the bits of the owner
          return;
        words(i, 0) = status(i);
        words(i, 1) = toWord(gap(i));
        for (int d = 0; has_slip && d < 3; ++d)
          words(i, 2 + d) = toWord(slip(i, d));
      });
  Kokkos::deep_copy(_space, of_mesh, 0);
  _coupling.sumOnMesh(_space, words, shared, of_mesh);
}

View<std::int64_t* [3]> ContactStep::normalForces(const Quantum& quantum,
                                                  mechanics::SharedNodeSum& shared) {
  View<std::int64_t* [3]> of_mesh("miniapp::ContactStep::normal_forces", _scene.mesh.num_nodes);
  if (!_has_forces_of_search)
    return of_mesh;
  const contact::Surface surface = _coupling.surface();
  const contact::ContactForces forces =
      contact::normalForces(_space, {surface, _search.ghosts()}, _enforcement->history(), quantum);
  _search.reverseSum(_space, surface.face_to_nodes, forces.ghost_corners, forces.nodes);
  _coupling.sumOnMesh(_space, forces.nodes, shared, of_mesh);
  return of_mesh;
}

void ContactStep::addSlip() {
  if (_slip.extent(0) > 0)
    contact::addSlip(_space, {surface(), _search.ghosts()}, _enforcement->history(), _slip);
}

View<std::int64_t**> ContactStep::slipOnMesh() {
  if (!_config.output.has(OutputField::slip_distance))
    return {};
  const View<std::int64_t**> words("miniapp::ContactStep::slip_words", _slip.extent(0), 1);
  const auto slip = _slip;
  Kokkos::parallel_for(
      "miniapp::ContactStep::packSlip", rangePolicy(_space, slip.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t i) { words(i, 0) = toWord(slip(i)); });
  View<std::int64_t**> of_mesh("miniapp::ContactStep::slip_of_mesh", _scene.mesh.num_nodes, 1);
  _coupling.sumOnMesh(_space, words, _slip_sum, of_mesh);
  return of_mesh;
}

void ContactStep::setSlip(const View<const std::int64_t**>& of_mesh) {
  if (!_config.output.has(OutputField::slip_distance))
    return;
  const contact::Surface surface = _coupling.surface();
  const View<std::int64_t**> words("miniapp::ContactStep::slip_words", surface.num_nodes, 1);
  _coupling.takeFromMesh(_space, of_mesh, words);
  _slip = View<double*>("miniapp::ContactStep::slip", surface.num_nodes);
  const auto slip = _slip;
  const auto is_owned = surface.node_is_owned;
  Kokkos::parallel_for(
      "miniapp::ContactStep::unpackSlip", rangePolicy(_space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        if (is_owned(i))
          fromWord(words(i, 0), slip(i));
      });
}

std::vector<std::int64_t> ContactStep::candidatesOfFaces() {
  const contact::Surface surface = _coupling.surface();
  const contact::CandidateCounts counts =
      contact::countCandidates(_space, {surface, _search.ghosts()}, _search.pairs());
  const auto itself = allocate<View<int* [4]>>(_space, "miniapp::ContactStep::candidatesOfFaces",
                                               counts.own.extent(0));
  Kokkos::parallel_for(
      "miniapp::ContactStep::candidatesOfFaces", rangePolicy(_space, itself.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t face) {
        for (int j = 0; j < 4; ++j)
          itself(face, j) = static_cast<int>(face);
      });
  _search.reverseSum(_space, itself, counts.of_ghosts, counts.own);

  const auto ids = toHost(surface.face_ids), primary_ids = toHost(_coupling.primary().face_ids);
  const auto own = toHost(counts.own);
  std::vector<FaceCount> records;
  for (int face = 0; face < surface.num_faces; ++face)
    records.push_back({ids(face), own(face, 0)});
  const std::vector<global_id> held(primary_ids.data(),
                                    primary_ids.data() + _coupling.primary().num_faces);
  std::unordered_map<global_id, std::int64_t> count_of;
  for (const FaceCount& record : contact::sendToHolders(
           _comm, records, held, [](const FaceCount& of_face) { return of_face.face; }))
    count_of[record.face] = record.count;
  std::vector<std::int64_t> of_faces;
  for (const global_id id : held)
    of_faces.push_back(count_of.at(id));
  return of_faces;
}

} // namespace brickwall::miniapp
