// Distribution of the faces of contact over ranks (contact_balance.hpp).
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/base/to_device.hpp"
#include "miniapp/simulation/contact_step.hpp"
#include "miniapp/simulation/stopwatch.hpp"

#include <numeric>

namespace brickwall::miniapp {

namespace {

// [surface node][0] the number of contacts of a node owned here.
View<std::int64_t**> contactsOfNodes(const exec_space& space,
                                     const contact::Enforcement& enforcement, int num_nodes) {
  View<std::int64_t**> counts("miniapp::ContactStep::contacts", num_nodes, 1);
  const auto row_count = enforcement.history().row_count;
  Kokkos::parallel_for(
      "miniapp::ContactStep::countContacts", rangePolicy(space, num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) { counts(i, 0) = row_count(i); });
  return counts;
}

// [surface node][low xyz, high xyz] the boxes of nodes owned here as words, and 0.
View<std::int64_t**> boxesOfOwned(const exec_space& space, const contact::Surface& surface,
                                  const View<const double* [6]>& boxes) {
  View<std::int64_t**> words("miniapp::ContactStep::boxes", surface.num_nodes, 6);
  const auto is_owned = surface.node_is_owned;
  Kokkos::parallel_for(
      "miniapp::ContactStep::packBoxes", rangePolicy(space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int w = 0; w < 6; ++w)
          words(i, w) = is_owned(i) ? toWord(boxes(i, w)) : 0;
      });
  return words;
}

std::vector<double> toDoubles(const View<std::int64_t**>& words) {
  const auto host = toHost(words);
  const std::size_t width = host.extent(1);
  std::vector<double> values(host.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    fromWord(host(i / width, i % width), values[i]);
  return values;
}

std::vector<global_id> ownedNodes(const contact::Surface& surface) {
  const auto ids = toHost(surface.node_ids);
  const auto is_owned = toHost(surface.node_is_owned);
  std::vector<global_id> owned;
  for (int node = 0; node < surface.num_nodes; ++node)
    if (is_owned(node))
      owned.push_back(ids(node));
  return owned;
}

std::vector<global_id> idsOf(const contact::EdgeContact& edges) {
  const auto ids = toHost(edges.nodeIds());
  return {ids.data(), ids.data() + ids.extent(0)};
}

} // namespace

bool ContactStep::mayBeDistributed() const {
  return sizeOf(_comm) > 1 && _config.search.decomposition != Decomposition::primary;
}

void ContactStep::distributeAtStart(const View<const double* [3]>& displacement) {
  if (!mayBeDistributed())
    return;
  _initial =
      allocate<View<double* [3]>>(_space, "miniapp::ContactStep::initial", displacement.extent(0));
  Kokkos::deep_copy(_space, _initial, displacement);
  if (_config.search.decomposition == Decomposition::surface) {
    _coupling.distribute(_space, _comm, ranksOfFaces());
    _coupling.resetCoordinates(_space, displacement);
  }
}

void ContactStep::balance(std::int64_t step, const View<const double* [3]>& displacement,
                          const contact::EnforcementSums& sums) {
  if (!mayBeDistributed() || step == 0 || step % ContactBalance::check_interval != 0)
    return;
  const double work = contactWork(surface().num_faces, static_cast<double>(sums.nodes.active));
  if (!_balance.isDue(work))
    return;
  const Region region("miniapp::distributeContact");
  const Stopwatch time;
  distribute(ranksOfFaces(), displacement);
  _balance.haveDistributed(time.seconds());
}

// By the contacts of the last step. Empty where the ranks of the elements do as well.
std::vector<int> ContactStep::ranksOfFaces() {
  contact::Surface primary = _coupling.primary();
  primary.coordinates_new = _coupling.primaryCoordinates();
  std::vector<float> work(primary.num_faces, 1);
  if (_enforcement) {
    const View<std::int64_t**> of_mesh("miniapp::ContactStep::contacts_of_mesh",
                                       _scene.mesh.num_nodes, 1);
    mechanics::SharedNodeSum shared(_scene.shared);
    _coupling.sumOnMesh(_space, contactsOfNodes(_space, *_enforcement, surface().num_nodes), shared,
                        of_mesh);
    const auto contacts = toHost(of_mesh);
    const auto face_to_nodes = toHost(_scene.skin.face_to_nodes);
    for (int face = 0; face < primary.num_faces; ++face)
      for (int j = 0; j < 4; ++j) // most nodes have four faces
        work[face] += static_cast<float>(
            0.25 * contactWork(0, static_cast<double>(contacts(face_to_nodes(face, j), 0))));
  }
  if (_config.search.decomposition == Decomposition::automatic &&
      imbalanceOf(_comm, std::accumulate(work.begin(), work.end(), 0.0)) <=
          ContactBalance::tolerated)
    return {};
  return balancedRanks(_comm, primary, work);
}

// CandidateSearch::sweptBoxes() as words [mesh node][low xyz, high xyz], at surface nodes; without
// rows if no lists are kept. Collective.
View<std::int64_t**> ContactStep::sweptBoxesOnMesh() {
  const auto boxes = _search.sweptBoxes();
  if (allReduce(_comm, boxes.extent(0) > 0 ? 1 : 0, MPI_MAX) == 0)
    return {};
  View<std::int64_t**> of_mesh("miniapp::ContactStep::boxes_of_mesh", _scene.mesh.num_nodes, 6);
  mechanics::SharedNodeSum shared(_scene.shared);
  _coupling.sumOnMesh(_space, boxesOfOwned(_space, surface(), boxes), shared, of_mesh);
  return of_mesh;
}

// Everything that depends on the decomposition is made as at the start, and the history of contact
// is moved to the ranks that own its nodes and edges: as in a restart.
void ContactStep::distribute(const std::vector<int>& rank_of_face,
                             const View<const double* [3]>& displacement) {
  if (!mayBeDistributed())
    return;
  _has_forces_of_search = false;
  contact::ContactCarry nodes = _enforcement->carry(_space, surface()), edges;
  if (_edges)
    edges = _edges->carry(_space);
  const View<std::int64_t**> boxes = sweptBoxesOnMesh();
  ContactRestart lists;
  lists.searches = _search.searches();
  lists.updates = _search.updates();

  _coupling.distribute(_space, _comm, rank_of_face);
  _coupling.resetCoordinates(_space, _initial);
  makeEnforcement();
  _coupling.resetCoordinates(_space, displacement);

  if (boxes.extent(0) > 0) {
    const View<std::int64_t**> words("miniapp::ContactStep::boxes", surface().num_nodes, 6);
    _coupling.takeFromMesh(_space, boxes, words);
    lists.swept_boxes = toDoubles(words);
  }
  _search.forget();
  restoreLists(lists);
  const auto ofNode = [](const auto& record) { return record.node; };
  const std::vector<global_id> owned = ownedNodes(surface());
  nodes.records = contact::sendToHolders(_comm, nodes.records, owned, ofNode);
  nodes.joints = contact::sendToHolders(_comm, nodes.joints, owned, ofNode);
  _enforcement->setReferenceStep(_guard.referenceStep());
  _enforcement->restore(_space, surface(), nodes);
  if (!_edges)
    return;
  edges.records = contact::sendToHolders(_comm, edges.records, idsOf(*_edges), ofNode);
  _edges->setTolerance(_search_tolerance);
  _edges->setReferenceStep(_guard.referenceStep());
  _edges->restore(_space, edges);
}

} // namespace brickwall::miniapp
