// Distribution of the faces of contact over ranks (contact_balance.hpp).
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/base/to_device.hpp"
#include "contact/surface/row_of_id.hpp"
#include "miniapp/simulation/contact_step.hpp"
#include "miniapp/timing/stopwatch.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace brickwall::miniapp {

namespace {

// Records of nodes on this rank to the ranks that own these now; `owners` [node]. Collective.
template <class Record>
std::vector<Record> sendToOwners(const Communicator& comm, const std::vector<Record>& records,
                                 const contact::RowOfId& row_of, const std::vector<int>& owners) {
  std::vector<std::vector<Record>> sent(sizeOf(comm));
  int row = 0;
  for (const Record& record : records) {
    row = row_of.findNear(row, record.node);
    sent[owners[row]].push_back(record);
  }
  std::vector<Record> all;
  for (const auto& some : exchangeByRank(comm, std::move(sent)))
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::vector<global_id> idsOf(const contact::EdgeContact& edges) {
  const auto ids = toHost(edges.nodeIds());
  return {ids.data(), ids.data() + ids.extent(0)};
}

// [surface node][1] this rank at nodes that it owns, and 0.
View<std::int64_t**> ranksOfOwners(const exec_space& space, MPI_Comm comm,
                                   const contact::Surface& surface) {
  View<std::int64_t**> ranks("miniapp::SurfaceCoupling::ranks", surface.num_nodes, 1);
  const auto is_owned = surface.node_is_owned;
  const int rank = rankOf(comm);
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::ranksOfOwners", rangePolicy(space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) { ranks(i, 0) = is_owned(i) ? rank : 0; });
  return ranks;
}

} // namespace

std::vector<int> SurfaceCoupling::distribute(const exec_space& space, const Communicator& comm,
                                             const std::vector<int>& rank_of_face) {
  std::unique_ptr<Secondary> former = std::move(_secondary);
  if (_is_shared.empty())
    _is_shared = sharedNodes(space);
  _features = _primary_features;
  _shares_listed = false;
  if (allReduce(comm, int(rank_of_face.size()), MPI_MAX) > 0) {
    contact::SecondarySurface surface(space, comm, _primary, rank_of_face, _is_shared);
    _features.convex = surface.forwardRecords(comm, _primary_features.convex);
    std::sort(_features.convex.begin(), _features.convex.end());
    const int num_nodes = surface.surface().num_nodes;
    const auto vectors = [&](const char* label) {
      return allocate<View<double* [3]>>(
          space, std::string("miniapp::SurfaceCoupling::secondary_") + label, num_nodes);
    };
    const auto node_mass =
        allocate<View<double*>>(space, "miniapp::SurfaceCoupling::secondary_node_mass", num_nodes);
    surface.forward(space, View<const double* [1]>(_node_mass.data(), _node_mass.extent(0)),
                    View<double* [1]>(node_mass.data(), num_nodes));
    _secondary = std::make_unique<Secondary>(Secondary{
        std::move(surface), vectors("x_old"), vectors("x_new"), vectors("accelerations"), node_mass,
        allocate<View<std::int64_t* [3]>>(space, "miniapp::SurfaceCoupling::forces",
                                          _primary.num_nodes),
        View<unsigned char*>("miniapp::SurfaceCoupling::is_listed_primary", _primary.num_nodes)});
  }

  _is_listed =
      View<unsigned char*>("miniapp::SurfaceCoupling::is_listed", this->surface().num_nodes);
  const auto of_primary = sumOnPrimary(space, ranksOfOwners(space, comm, surface()));
  const auto owners = toHost(fromPrimary(space, of_primary, former.get()));
  std::vector<int> rank_of_node(owners.extent(0));
  for (std::size_t node = 0; node < rank_of_node.size(); ++node)
    rank_of_node[node] = static_cast<int>(owners(node, 0));
  return rank_of_node;
}

// Whether each node of the primary surface is on that of another rank, too.
std::vector<char> SurfaceCoupling::sharedNodes(const exec_space& space) {
  const View<std::int64_t**> uses("miniapp::SurfaceCoupling::uses", _primary.num_nodes, 1);
  Kokkos::deep_copy(space, uses, 1);
  const auto host = toHost(sumOnPrimary(space, uses));
  std::vector<char> is_shared(_primary.num_nodes);
  for (std::size_t node = 0; node < is_shared.size(); ++node)
    is_shared[node] = host(node, 0) > 1;
  return is_shared;
}

bool ContactStep::mayBeDistributed() const {
  return sizeOf(_comm) > 1 && _config.search.decomposition != Decomposition::primary;
}

void ContactStep::distributeAtStart(const View<const double* [3]>& displacement) {
  if (!mayBeDistributed() || _config.search.decomposition != Decomposition::surface)
    return;
  _coupling.distribute(_space, _comm,
                       ranksOfFaces(std::vector<float>(_coupling.primary().num_faces, 1)));
  _coupling.resetCoordinates(_space, displacement);
}

void ContactStep::balance(std::int64_t step, const View<const double* [3]>& displacement) {
  if (!mayBeDistributed() || step == 0 || step % ContactBalance::check_interval != 0)
    return;
  const Region region("miniapp::balanceContact");
  const View<std::int64_t**> work_of_nodes = workOfNodes();
  const double work = workOfRank(work_of_nodes);
  std::vector<float> of_faces;
  double work_at_home = work;
  if (!_balance.areHome()) {
    of_faces = workOfFaces(work_of_nodes);
    work_at_home = std::accumulate(of_faces.begin(), of_faces.end(), 0.0);
  }
  if (!_balance.isDue(work, work_at_home))
    return;
  const Stopwatch time;
  const bool may_return = _config.search.decomposition == Decomposition::automatic;
  if (may_return && _balance.isHomeBetter()) {
    distribute({}, displacement);
    _balance.haveReturned(time.seconds());
    return;
  }
  if (_balance.areHome())
    of_faces = workOfFaces(work_of_nodes);
  const std::vector<int> ranks = ranksOfFaces(of_faces);
  distribute(ranks, displacement);
  _balance.haveDistributed(time.seconds(), imbalanceOf(_comm, of_faces, ranks), !may_return);
}

View<std::int64_t**> ContactStep::workOfNodes() const {
  View<std::int64_t**> work("miniapp::ContactStep::work", surface().num_nodes, 1);
  _enforcement->addWork(_space, _search.pairs(), work);
  if (_edges)
    _edges->addWork(_space, work);
  return work;
}

double ContactStep::workOfRank(const View<std::int64_t**>& of_nodes) const {
  std::int64_t sum = 0;
  Kokkos::parallel_reduce(
      "miniapp::ContactStep::sumWork", rangePolicy(_space, of_nodes.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t i, std::int64_t& part) { part += of_nodes(i, 0); }, sum);
  return static_cast<double>(contact::WorkUnits::face * surface().num_faces + sum);
}

std::vector<float> ContactStep::workOfFaces(const View<std::int64_t**>& of_nodes) {
  std::vector<float> work(_coupling.primary().num_faces, contact::WorkUnits::face);
  const auto of_primary = toHost(_coupling.sumOnPrimary(_space, of_nodes));
  const auto face_to_nodes = toHost(_coupling.primary().face_to_nodes);
  for (std::size_t face = 0; face < work.size(); ++face)
    for (int j = 0; j < 4; ++j) // most nodes have four faces
      work[face] += 0.25F * static_cast<float>(of_primary(face_to_nodes(face, j), 0));
  return work;
}

std::vector<int> ContactStep::ranksOfFaces(const std::vector<float>& work) const {
  contact::Surface primary = _coupling.primary();
  primary.coordinates_new = _coupling.primaryCoordinates();
  return balancedRanks(_comm, primary, work);
}

// What depends on the decomposition is made anew, and the history of contact is moved to the ranks
// that own its nodes and edges.
void ContactStep::distribute(const std::vector<int>& rank_of_face,
                             const View<const double* [3]>& displacement) {
  if (!mayBeDistributed())
    return;
  _has_forces_of_search = false;
  contact::ContactCarry nodes = _enforcement->carry(_space, surface()), edges;
  if (_edges)
    edges = _edges->carry(_space);
  View<const double* [6]> boxes = _search.sweptBoxes(); // of copies of a node the same on all ranks
  const bool has_boxes = allReduce(_comm, boxes.extent(0) > 0 ? 1 : 0, MPI_MAX) > 0;
  if (has_boxes)
    boxes = _coupling.toPrimary(_space, boxes);
  const View<std::int64_t**> slip = slipOnMesh();
  const std::int64_t searches = _search.searches(), updates = _search.updates();

  const contact::RowOfId row_of(surface().node_ids);
  const std::vector<int> owners = _coupling.distribute(_space, _comm, rank_of_face);
  _coupling.resetCoordinates(_space, displacement);
  makeEnforcement();
  setSlip(slip);

  _search.forget();
  searchIn(has_boxes ? _coupling.fromPrimary(_space, boxes) : View<const double* [6]>(), searches,
           updates);
  nodes.records = sendToOwners(_comm, nodes.records, row_of, owners);
  nodes.joints = sendToOwners(_comm, nodes.joints, row_of, owners);
  _enforcement->setReferenceStep(_guard.referenceStep());
  _enforcement->restore(_space, surface(), nodes);
  if (!_edges)
    return;
  edges.records =
      contact::sendToHolders(_comm, edges.records, idsOf(*_edges),
                             [](const contact::ContactRecord& record) { return record.node; });
  _edges->setTolerance(_search_tolerance);
  _edges->setReferenceStep(_guard.referenceStep());
  _edges->restore(_space, edges);
}

} // namespace brickwall::miniapp
