#include "contact/enforcement/node_face/find_joint_areas.hpp"

#include "contact/base/region.hpp"
#include "contact/base/scan.hpp"
#include "contact/base/sum_over.hpp"
#include "contact/enforcement/law/correct_pair.hpp"
#include "contact/enforcement/law/pair_forces.hpp"
#include "contact/enforcement/node_face/flush_contacts.hpp"

#include <cmath>
#include <string>

namespace brickwall::contact {
namespace {

// Areas are not changed if nodal forces err by less than `needless`; they are improved until all
// err by less than `sufficient`, or for `max_rounds`.
constexpr double needless = 1e-6, sufficient = 1e-3;
constexpr int max_rounds = 300, rounds_per_check = 10;
// Least area over the tributary area.
constexpr double min_share = 1e-3;
// A corner is covered if the sum of the normals of its contacts leads against the face's normal.
constexpr double covered_cosine = 0.9;

// Which corners of own faces are covered by contacts.
struct Coverage {
  static constexpr double unit = 1 << 30;
  FaceAccess faces;
  View<const std::int64_t* [3]> normals; // sums of the normals of contacts in 1/unit [node][xyz]

  KOKKOS_INLINE_FUNCTION bool covers(int face, int j) const {
    const Vec3 normal = planeOfArea(areaVector(faces.quad(face))).normal;
    const int node = faces.surface.face_to_nodes(face, j);
    double along = 0;
    for (int d = 0; d < 3; ++d)
      along += normal[d] * static_cast<double>(normals(node, d));
    return along < -covered_cosine * unit;
  }
  KOKKOS_INLINE_FUNCTION int count(int face) const {
    int count = 0;
    for (int j = 0; j < 4; ++j)
      count += covers(face, j);
    return count;
  }
};

// The areas a = A (1 + G^T y), within bounds, that change A least such that G a = T; eqs. (37) to
// (39). Contacts are kept as interactions: `stiffness` is A, `force` is a.
struct JointProblem {
  JointProblem(const exec_space& space, const Communicator& comm,
               const NodeFaceKinematics& kinematics, const FaceAccess& faces,
               const CandidatePairs& pairs, const NeutralInput& host)
      : _space(space), _comm(comm), _faces(faces), _host(host), _num_nodes(pairs.num_rows) {
    findContacts(kinematics, pairs);
    divideAreas(pairs, kinematics.shared_cosine);
  }

  // Collective. Whether the areas have been changed.
  bool solve();
  JointAreas areas() const;

  void findContacts(const NodeFaceKinematics& kinematics, const CandidatePairs& pairs);
  void divideAreas(const CandidatePairs& pairs, double shared_cosine);
  Coverage findCoverage();
  void findTargets();
  void leaveOutPartlyCovered(const Coverage& coverage);
  void findDiagonal();
  void addAreas();
  double largestError() const;
  bool ascend(double momentum);
  void sum() { _host.sum_forces(_sums); }
  void zeroSums() {
    Kokkos::deep_copy(_space, _sums.nodes, std::int64_t(0));
    Kokkos::deep_copy(_space, _sums.ghost_corners, std::int64_t(0));
  }
  PairForces pairForces() const {
    return {_faces, _sums, _quantum.inverse, 4, false, concurrency(_space) == 1, {}};
  }
  template <class T>
  T allocated(const std::string& name, std::int64_t count) const {
    return T("contact::findJointAreas::" + name, count);
  }

  exec_space _space;
  const Communicator& _comm;
  FaceAccess _faces;
  const NeutralInput& _host;
  int _num_nodes;
  std::int64_t _count = 0;
  View<std::int64_t*> _offsets; // [row]
  View<Interaction*> _contacts;
  View<int*> _row_begin, _row_count; // [node]
  Quantum _quantum; // of area
  ContactForces _sums; // G a, in quanta
  View<std::int64_t* [3]> _targets; // T in quanta; 0 at nodes that are not covered [node][xyz]
  View<double*> _diagonal; // bound of the row sums of G A G^T, length^2 [node]
  View<double*[3]> _y, _last_y; // [node][xyz]
  View<double* [12]> _ghost_y;
};

void JointProblem::findContacts(const NodeFaceKinematics& kinematics, const CandidatePairs& pairs) {
  const FlushContacts flush{kinematics, _faces, pairs,
                            allocated<View<unsigned char*>>("is_chosen", pairs.faces.extent(0))};
  Kokkos::parallel_for(
      "contact::findJointAreas::choose", rangePolicy(_space, _num_nodes),
      KOKKOS_LAMBDA(const std::int64_t row) { flush.choose(row); });
  const auto offsets = _offsets = allocated<View<std::int64_t*>>("offsets", _num_nodes + 1);
  launchScan(_space, "contact::findJointAreas::scan", flush, _num_nodes, offsets);
  Kokkos::deep_copy(_space, _count, Kokkos::subview(offsets, static_cast<std::size_t>(_num_nodes)));
  _space.fence();
  const auto contacts = _contacts = allocated<View<Interaction*>>("contacts", _count);
  Kokkos::parallel_for(
      "contact::findJointAreas::fill", rangePolicy(_space, _num_nodes),
      KOKKOS_LAMBDA(const std::int64_t row) {
        std::int64_t next = offsets(row);
        for (std::int64_t p = pairs.begin(row); next < offsets(row + 1); ++p)
          if (flush.is_chosen(p))
            contacts(next++) = flush.contact(pairs.node(row), pairs.faces(p));
      });
}

// Contacts of a node with nearly equal normals share its area.
void JointProblem::divideAreas(const CandidatePairs& pairs, double shared_cosine) {
  _row_begin = allocated<View<int*>>("row_begin", _num_nodes);
  _row_count = allocated<View<int*>>("row_count", _num_nodes);
  const auto row_begin = _row_begin, row_count = _row_count;
  const auto offsets = _offsets;
  const auto contacts = _contacts;
  double largest = 0;
  Kokkos::parallel_reduce(
      "contact::findJointAreas::divideAreas", rangePolicy(_space, _num_nodes),
      KOKKOS_LAMBDA(const std::int64_t row, double& area) {
        const std::int64_t begin = offsets(row), end = offsets(row + 1);
        row_begin(pairs.node(row)) = static_cast<int>(begin);
        row_count(pairs.node(row)) = static_cast<int>(end - begin);
        for (std::int64_t i = begin; i < end; ++i) {
          int sharing = 0;
          for (std::int64_t j = begin; j < end; ++j)
            sharing += j == i || dot(contacts(i).normal, contacts(j).normal) > shared_cosine;
          contacts(i).stiffness = contacts(i).force / sharing;
          area = maxOf(area, contacts(i).force);
        }
      },
      Kokkos::Max<double>(largest));
  largest = allReduce(_comm, largest, MPI_MAX);
  _quantum = Quantum::forForceScale(largest > 0 ? 16 * largest : 1); // a node has many contacts
}

Coverage JointProblem::findCoverage() {
  const auto normals = allocated<View<std::int64_t* [3]>>("normals", _num_nodes);
  const auto contacts = _contacts;
  const auto sums = _sums;
  zeroSums();
  Kokkos::parallel_for(
      "contact::findJointAreas::addNormals", rangePolicy(_space, _count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int d = 0; d < 3; ++d)
          Kokkos::atomic_add(&sums.nodes(contacts(i).node, d),
                             roundToFixed(Coverage::unit * contacts(i).normal[d]));
      });
  sum();
  Kokkos::deep_copy(_space, normals, sums.nodes);
  return {_faces, normals};
}

// T: twice, for both passes, the integrals of N over the faces whose corners are all covered by
// contacts against them. Nodes at faces that are covered in part are left out.
void JointProblem::findTargets() {
  const Coverage coverage = findCoverage();
  const auto faces = _faces;
  const auto quantum = _quantum;
  const auto sums = _sums;
  zeroSums();
  Kokkos::parallel_for(
      "contact::findJointAreas::addTargets", rangePolicy(_space, faces.surface.num_faces),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int face = static_cast<int>(i);
        if (coverage.count(face) < 4)
          return;
        const Quad quad = faces.quad(face);
        const Vec3* q = quad.corner;
        Vec3 at[4]; // area vector over d xi d eta/4 at each corner, linear on the face
        for (int j = 0; j < 4; ++j)
          at[j] = 0.25 * cross(q[(j + 1) & 3] - q[j], q[(j + 3) & 3] - q[j]);
        for (int j = 0; j < 4; ++j) {
          const Vec3 integral =
              (-2.0 / 9) * (4 * at[j] + 2 * (at[(j + 1) & 3] + at[(j + 3) & 3]) + at[(j + 2) & 3]);
          for (int d = 0; d < 3; ++d)
            Kokkos::atomic_add(&sums.nodes(faces.surface.face_to_nodes(face, j), d),
                               roundToFixed(quantum.inverse * integral[d]));
        }
      });
  sum();
  _targets = allocated<View<std::int64_t* [3]>>("targets", _num_nodes);
  Kokkos::deep_copy(_space, _targets, sums.nodes);
  leaveOutPartlyCovered(coverage);
}

void JointProblem::leaveOutPartlyCovered(const Coverage& coverage) {
  const auto faces = _faces;
  const auto sums = _sums;
  zeroSums();
  Kokkos::parallel_for(
      "contact::findJointAreas::findPartlyCovered", rangePolicy(_space, faces.surface.num_faces),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int face = static_cast<int>(i), covered = coverage.count(face);
        if (covered > 0 && covered < 4)
          for (int j = 0; j < 4; ++j)
            if (coverage.covers(face, j))
              Kokkos::atomic_add(&sums.nodes(faces.surface.face_to_nodes(face, j), 0),
                                 std::int64_t(1));
      });
  sum();
  const auto targets = _targets;
  Kokkos::parallel_for(
      "contact::findJointAreas::leaveOut", rangePolicy(_space, _num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        if (sums.nodes(node, 0) != 0)
          for (int d = 0; d < 3; ++d)
            targets(node, d) = 0;
      });
}

// Twice the sum of A |G| at each node: the sums of the rows of |G| A |G|^T.
void JointProblem::findDiagonal() {
  const auto contacts = _contacts;
  const auto sums = _sums;
  const PairForces add = pairForces();
  zeroSums();
  Kokkos::parallel_for(
      "contact::findJointAreas::addMagnitudes", rangePolicy(_space, _count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        Interaction pair = contacts(i);
        pair.normal = {1, 0, 0};
        add.addMagnitude(pair, pair.stiffness);
      });
  sum();
  _diagonal = allocated<View<double*>>("diagonal", _num_nodes);
  const auto diagonal = _diagonal;
  const auto quantum = _quantum;
  Kokkos::parallel_for(
      "contact::findJointAreas::diagonal", rangePolicy(_space, _num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        diagonal(node) = 2 * quantum.value * static_cast<double>(sums.nodes(node, 0));
      });
}

// a and G a.
void JointProblem::addAreas() {
  const auto contacts = _contacts;
  const PairForces add = pairForces();
  const CorrectPair relative{_faces, {_y, _ghost_y}, {}, 1, 1, 0, 0};
  zeroSums();
  Kokkos::parallel_for(
      "contact::findJointAreas::addAreas", rangePolicy(_space, _count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        Interaction& pair = contacts(i);
        const double share = 1 + dot(pair.normal, relative.relativeAcceleration(pair));
        pair.force = pair.stiffness * minOf(maxOf(share, min_share), JointAreas::max_share);
        PairQuanta<double> quanta;
        add.round(pair, {}, {}, quanta);
        add.add(pair, quanta, 1);
      });
  sum();
}

KOKKOS_INLINE_FUNCTION bool hasTarget(const View<std::int64_t* [3]>& targets, std::int64_t node) {
  return targets(node, 0) != 0 || targets(node, 1) != 0 || targets(node, 2) != 0;
}

// Collective. |T - G a| over |T|.
double JointProblem::largestError() const {
  const auto targets = _targets;
  const auto sums = _sums;
  double largest = 0;
  Kokkos::parallel_reduce(
      "contact::findJointAreas::largestError", rangePolicy(_space, _num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, double& most) {
        if (!hasTarget(targets, node))
          return;
        Vec3 target, error;
        for (int d = 0; d < 3; ++d) {
          target[d] = static_cast<double>(targets(node, d));
          error[d] = static_cast<double>(targets(node, d) - sums.nodes(node, d));
        }
        most = maxOf(most, norm(error) / norm(target));
      },
      Kokkos::Max<double>(largest));
  return allReduce(_comm, largest, MPI_MAX);
}

// Collective. A step of the accelerated gradient method. Returns whether it led uphill, as far as
// the gradient tells; otherwise the momentum has carried y too far.
bool JointProblem::ascend(double momentum) {
  const auto targets = _targets;
  const auto sums = _sums;
  const auto y = _y, last_y = _last_y;
  const auto diagonal = _diagonal;
  const auto quantum = _quantum;
  const auto is_owned = _faces.surface.node_is_owned;
  const LimbScale scale = LimbScale::forLargest(std::ldexp(quantum.value, 80));
  auto uphill = sumOver<LimbSums<1>>(
      "contact::findJointAreas::ascend", _space, 0, _num_nodes,
      KOKKOS_LAMBDA(const std::int64_t node, LimbSums<1>& sum) {
        if (!hasTarget(targets, node))
          return;
        for (int d = 0; d < 3; ++d) {
          const double missing =
              quantum.value * static_cast<double>(targets(node, d) - sums.nodes(node, d));
          const double next = y(node, d) + missing / diagonal(node);
          if (is_owned(node))
            sum.add(0, missing * (next - last_y(node, d)), scale);
          y(node, d) = next + momentum * (next - last_y(node, d));
          last_y(node, d) = next;
        }
      });
  allReduce(_comm, uphill);
  _host.share_with_ghosts(_y, _ghost_y);
  return uphill.sum[0].value(scale) >= 0;
}

bool JointProblem::solve() {
  if (allReduce(_comm, _count, MPI_SUM) == 0)
    return false;
  _sums.nodes = allocated<View<std::int64_t* [3]>>("sums", _num_nodes);
  _sums.ghost_corners = allocated<View<std::int64_t* [12]>>("ghost_sums", _faces.ghosts.count);
  _y = allocated<View<double* [3]>>("y", _num_nodes);
  _last_y = allocated<View<double* [3]>>("last_y", _num_nodes);
  _ghost_y = allocated<View<double* [12]>>("ghost_y", _faces.ghosts.count);
  findTargets();
  findDiagonal();
  addAreas();
  double error = largestError(), t = 1;
  if (error < needless)
    return false;
  for (int round = 1; !(error < sufficient) && round <= max_rounds; ++round) {
    const double next_t = (1 + std::sqrt(1 + 4 * t * t)) / 2;
    t = ascend((t - 1) / next_t) ? next_t : 1;
    addAreas();
    if (round % rounds_per_check == 0)
      error = largestError();
  }
  return true;
}

JointAreas JointProblem::areas() const {
  const auto sides = allocated<View<global_id*>>("sides", _count);
  const auto areas = allocated<View<double*>>("areas", _count);
  const auto contacts = _contacts;
  Kokkos::parallel_for(
      "contact::findJointAreas::areas", rangePolicy(_space, _count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        sides(i) = contacts(i).side;
        areas(i) = contacts(i).force;
      });
  return {_row_begin, _row_count, sides, areas};
}

} // namespace

JointAreas findJointAreas(const exec_space& space, const Communicator& comm,
                          const NodeFaceKinematics& kinematics, const FaceAccess& faces,
                          const CandidatePairs& pairs, const NeutralInput& host) {
  Region region("contact::findJointAreas");
  JointProblem problem(space, comm, kinematics, faces, pairs, host);
  return problem.solve() ? problem.areas() : JointAreas();
}

} // namespace brickwall::contact
