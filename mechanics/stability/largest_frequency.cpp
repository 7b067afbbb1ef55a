#include "mechanics/stability/largest_frequency.hpp"

#include "contact/base/hash.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "mechanics/element/rest_stiffness.hpp"
#include "mechanics/mesh/body_types.hpp"
#include "mechanics/mesh/host_mesh.hpp"
#include "mechanics/mesh/lumped_mass.hpp"
#include "mechanics/mesh/shared_node_sum.hpp"
#include "mechanics/stability/ritz_value.hpp"

#include <algorithm>

namespace brickwall::mechanics {

namespace {

using Vectors = View<double* [3]>;

// Small bodies take more products; all products of an element together take about a second.
int productsFor(std::int64_t num_elems) {
  constexpr std::int64_t least = 60, most = 120, elem_products = 1 << 22;
  return static_cast<int>(
      minOf(most, maxOf(least, elem_products / maxOf<std::int64_t>(num_elems, 1))));
}

// eps of the header.
double shareMissed(std::int64_t unknowns, int products) {
  constexpr double chance = 1e-3;
  const double root =
      std::log(1.648 * std::sqrt(static_cast<double>(unknowns)) / chance) / (2 * products - 1);
  return root * root;
}

// One body of each type, as a mesh of its own.
struct Representatives {
  HexMesh mesh;
  SharedNodeSum shared;
  View<double*> mass; // [node]
  View<global_id*> seeds; // [node]: node id less the body's lowest, so that copies have equal seeds
  std::int64_t num_elems = 0, num_nodes = 0; // over all ranks
};

// Their elements and nodes on this rank, on the host.
struct ChosenElements {
  std::vector<int> elem_nodes, elem_block; // [elem][corner], [elem]
  std::vector<global_id> elem_ids;
  std::vector<double> coordinates, masses; // [node][xyz], [node]
  std::vector<unsigned char> owned;
  std::vector<global_id> seeds;
  std::vector<int> new_node; // [node of the whole mesh] -1: of none of these bodies
};

ChosenElements chooseElements(const exec_space& space, const HexMesh& mesh,
                              const View<const double*>& mass, const BodyTypes& types) {
  const HostMesh host = copyToHost(space, mesh);
  const auto is_owned = toHost(mesh.node_is_owned);
  const auto host_mass = toHost(mass);
  ChosenElements chosen;
  chosen.new_node.assign(static_cast<std::size_t>(mesh.num_nodes), -1);
  const auto choose = [&](int node, global_id first_node) {
    int& new_node = chosen.new_node[node];
    if (new_node < 0) {
      new_node = static_cast<int>(chosen.seeds.size());
      chosen.seeds.push_back(host.node_ids(node) - first_node);
      chosen.owned.push_back(is_owned(node));
      chosen.masses.push_back(host_mass(node));
      for (int j = 0; j < 3; ++j)
        chosen.coordinates.push_back(host.reference_coordinates(node, j));
    }
    return new_node;
  };
  for (std::size_t b = 0; b < mesh.bodies.size(); ++b) {
    const ElementRange& body = mesh.bodies[b];
    if (types.representative[b] != body.body)
      continue;
    for (int elem = body.first; elem < body.first + body.count; ++elem) {
      for (int c = 0; c < 8; ++c)
        chosen.elem_nodes.push_back(choose(host.elem_to_nodes(elem, c), types.first_node[b]));
      chosen.elem_block.push_back(host.elem_block(elem));
      chosen.elem_ids.push_back(host.elem_ids(elem));
    }
  }
  return chosen;
}

// Those of the nodes that are chosen: both sharers keep the same nodes in the same order.
SharedNodeLists sharedOf(const SharedNodeLists& shared, const std::vector<int>& new_node) {
  SharedNodeLists lists;
  for (std::size_t p = 0; p < shared.ranks.size(); ++p) {
    std::vector<int> nodes;
    for (const int node : shared.nodes[p])
      if (new_node[node] >= 0)
        nodes.push_back(new_node[node]);
    if (nodes.empty())
      continue;
    lists.ranks.push_back(shared.ranks[p]);
    lists.nodes.push_back(nodes);
  }
  return lists;
}

Representatives representativesOf(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                  const SharedNodeLists& shared, const View<const double*>& mass,
                                  const BodyTypes& types) {
  const ChosenElements chosen = chooseElements(space, mesh, mass, types);
  Representatives bodies;
  bodies.mesh.num_nodes = static_cast<int>(chosen.seeds.size());
  bodies.mesh.num_elems = static_cast<int>(chosen.elem_ids.size());
  bodies.num_elems = allReduce(comm, static_cast<std::int64_t>(bodies.mesh.num_elems), MPI_SUM);
  bodies.num_nodes = allReduce(
      comm, static_cast<std::int64_t>(std::count(chosen.owned.begin(), chosen.owned.end(), 1)),
      MPI_SUM);
  bodies.mesh.elem_to_nodes = toDevice<View<int* [8]>>(
      space, "mechanics::largestFrequency::elem_to_nodes", chosen.elem_nodes);
  bodies.mesh.elem_ids = toDevice(space, "mechanics::largestFrequency::elem_ids", chosen.elem_ids);
  bodies.mesh.node_is_owned = toDevice(space, "mechanics::largestFrequency::owned", chosen.owned);
  bodies.mesh.elem_block =
      toDevice(space, "mechanics::largestFrequency::elem_block", chosen.elem_block);
  bodies.mesh.materials = mesh.materials;
  bodies.mesh.reference_coordinates =
      toDevice<View<double* [3]>>(space, "mechanics::largestFrequency::X", chosen.coordinates);
  bodies.shared = SharedNodeSum(space, comm, sharedOf(shared, chosen.new_node));
  bodies.mass = toDevice(space, "mechanics::largestFrequency::mass", chosen.masses);
  bodies.seeds = toDevice(space, "mechanics::largestFrequency::seeds", chosen.seeds);
  return bodies;
}

template <class Geometry>
View<Geometry*> geometriesOf(const exec_space& space, const HexMesh& mesh) {
  auto geometries =
      allocate<View<Geometry*>>(space, "mechanics::largestFrequency::geometries", mesh.num_elems);
  const MeshViews m = viewsOf(mesh);
  Kokkos::parallel_for(
      "mechanics::largestFrequency::geometry", rangePolicy(space, mesh.num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem) {
        CornerCoordinates X;
        gatherCorners(m.elem_to_nodes, m.reference_coordinates, static_cast<int>(elem), X);
        Geometry geometry;
        makeGeometry(X, geometry);
        geometries(elem) = geometry;
      });
  return geometries;
}

// sums += M^-1 K v/omega^2 of the element bound, in units of `quantum`.
template <class Geometry>
struct AddProduct {
  MeshViews mesh;
  View<const Geometry*> geometries;
  View<const double*> mass;
  View<const double* [3]> v;
  View<std::int64_t**> sums; // [node][xyz]
  double inverse_unit; // 1/(omega^2 quantum)

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t e) const {
    const int elem = static_cast<int>(e);
    double corners[8][3], u[3][num_modes], forces[3][num_modes];
    gatherCorners(mesh.elem_to_nodes, v, elem, corners);
    coordinateModes(corners, u);
    const Geometry geometry = geometries(elem);
    restForces(u, geometry, mesh.materials(mesh.elem_block(elem)), forces);
    for (int i = 0; i < 3; ++i) {
      double corner[8];
      modesToCorners(forces[i], corner);
      for (int c = 0; c < 8; ++c) {
        const int node = mesh.elem_to_nodes(elem, c);
        Kokkos::atomic_add(&sums(node, i), roundToFixed(corner[c] * (inverse_unit / mass(node))));
      }
    }
  }
};

// The Lanczos iteration: w is the next direction, v the present one.
class Lanczos {
public:
  Lanczos(const exec_space& space, MPI_Comm comm, Representatives& bodies)
      : _space(space), _comm(comm), _bodies(bodies),
        _before("mechanics::largestFrequency::before", bodies.mesh.num_nodes),
        _v("mechanics::largestFrequency::v", bodies.mesh.num_nodes),
        _w("mechanics::largestFrequency::w", bodies.mesh.num_nodes),
        _sums("mechanics::largestFrequency::sums", bodies.mesh.num_nodes, 3) {}

  // Returns false if the masses differ too much for fixed point: each |v_i| is at most sqrt(total
  // mass/mass of the node).
  bool begin();
  // One product; the residual is that of the largest Ritz value.
  template <class Geometry>
  void iterate(const View<Geometry*>& geometries, double omega_square);

  // The Ritz value is an eigenvalue up to rounding. To miss a larger one the start vector would
  // have to lack it to a dozen digits.
  bool isConverged() const { return residual() <= 1e-12 * _ritz.value; }

  const RitzValue& ritz() const { return _ritz; }
  double residual() const { return _beta.back() * _ritz.last; }
  int products() const { return static_cast<int>(_alpha.size()); }

private:
  // Sum of m a.b over the total mass. Collective.
  double dot(const Vectors& a, const Vectors& b) const;

  exec_space _space;
  MPI_Comm _comm;
  Representatives& _bodies;
  double _total_mass = 1, _quantum = 1;
  Vectors _before, _v, _w;
  View<std::int64_t**> _sums;
  std::vector<double> _alpha, _beta;
  RitzValue _ritz;
};

struct DotTerms {
  View<const double*[3]> a, b;
  View<const double*> mass;
  View<const unsigned char*> is_owned;
  double inverse_mass;
  LimbScale scale;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node, LimbSums<1>& sum) const {
    if (is_owned(node))
      sum.add(0,
              inverse_mass * mass(node) *
                  (a(node, 0) * b(node, 0) + a(node, 1) * b(node, 1) + a(node, 2) * b(node, 2)),
              scale);
  }
};

double Lanczos::dot(const Vectors& a, const Vectors& b) const {
  const LimbScale scale = LimbScale::forLargest(4);
  LimbSums<1> sum;
  Kokkos::parallel_reduce(
      "mechanics::largestFrequency::dot", rangePolicy(_space, _bodies.mesh.num_nodes),
      DotTerms{a, b, _bodies.mass, _bodies.mesh.node_is_owned, 1 / _total_mass, scale},
      PlusReducer<LimbSums<1>>(sum));
  allReduce(_comm, sum);
  return sum.sum[0].value(scale);
}

struct StartVector {
  View<const global_id*> seeds;
  Vectors v;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node) const {
    for (int i = 0; i < 3; ++i)
      v(node, i) = randomOf(static_cast<std::uint64_t>(3 * seeds(node) + i));
  }
};

struct Scale {
  double factor;
  Vectors from, to;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node) const {
    for (int i = 0; i < 3; ++i)
      to(node, i) = factor * from(node, i);
  }
};

struct FromSums {
  View<const std::int64_t**> sums;
  double quantum;
  Vectors w;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node) const {
    for (int i = 0; i < 3; ++i)
      w(node, i) = quantum * static_cast<double>(sums(node, i));
  }
};

// w -= alpha v + beta before; then `before` takes the place of v.
struct Orthogonalise {
  double alpha, beta;
  Vectors before, v, w;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node) const {
    for (int i = 0; i < 3; ++i) {
      w(node, i) -= alpha * v(node, i) + beta * before(node, i);
      before(node, i) = v(node, i);
    }
  }
};

struct LeastMass {
  View<const double*> mass;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node, double& least) const {
    least = minOf(least, mass(node));
  }
};

bool Lanczos::begin() {
  const int num_nodes = _bodies.mesh.num_nodes;
  _total_mass = totalMass(_space, _comm, _bodies.mesh, _bodies.mass);
  double least = HUGE_VAL;
  Kokkos::parallel_reduce("mechanics::largestFrequency::least_mass", rangePolicy(_space, num_nodes),
                          LeastMass{_bodies.mass}, Kokkos::Min<double>(least));
  least = allReduce(_comm, least, MPI_MIN);
  const int bits = 54 - static_cast<int>(std::ceil(0.5 * std::log2(_total_mass / least)));
  if (!(bits >= 30))
    return false;
  _quantum = std::ldexp(1.0, -bits);
  Kokkos::parallel_for("mechanics::largestFrequency::start", rangePolicy(_space, num_nodes),
                       StartVector{_bodies.seeds, _w});
  _beta.assign(1, std::sqrt(dot(_w, _w)));
  return true;
}

template <class Geometry>
void Lanczos::iterate(const View<Geometry*>& geometries, double omega_square) {
  const HexMesh& mesh = _bodies.mesh;
  Kokkos::parallel_for("mechanics::largestFrequency::next", rangePolicy(_space, mesh.num_nodes),
                       Scale{1 / _beta.back(), _w, _v});
  Kokkos::deep_copy(_space, _sums, std::int64_t(0));
  Kokkos::parallel_for("mechanics::largestFrequency::product", rangePolicy(_space, mesh.num_elems),
                       AddProduct<Geometry>{viewsOf(mesh), geometries, _bodies.mass, _v, _sums,
                                            1 / (omega_square * _quantum)});
  _bodies.shared.sum(_space, _sums);
  Kokkos::parallel_for("mechanics::largestFrequency::convert", rangePolicy(_space, mesh.num_nodes),
                       FromSums{_sums, _quantum, _w});
  const double alpha = dot(_w, _v);
  Kokkos::parallel_for("mechanics::largestFrequency::orthogonalise",
                       rangePolicy(_space, mesh.num_nodes),
                       Orthogonalise{alpha, _alpha.empty() ? 0.0 : _beta.back(), _before, _v, _w});
  _alpha.push_back(alpha);
  _beta.push_back(std::sqrt(dot(_w, _w)));
  _ritz = largestRitzValue(_alpha, {_beta.begin() + 1, _beta.end()});
}

template <class Geometry>
LargestFrequency converge(const exec_space& space, MPI_Comm comm, Representatives& bodies,
                          double omega_square) {
  LargestFrequency result;
  Lanczos lanczos(space, comm, bodies);
  if (!lanczos.begin())
    return result;
  const auto geometries = geometriesOf<Geometry>(space, bodies.mesh);
  const int products = productsFor(bodies.num_elems);
  while (lanczos.products() == 0 || (lanczos.products() < products && !lanczos.isConverged()))
    lanczos.iterate(geometries, omega_square);
  space.fence();
  constexpr double rounding = 1e-9;
  const double missed =
      lanczos.isConverged() ? 0 : shareMissed(3 * bodies.num_nodes, lanczos.products());
  result.ritz = omega_square * lanczos.ritz().value;
  result.bound.elements = omega_square;
  result.bound.bodies = omega_square * minOf(1.0, lanczos.ritz().value / (1 - missed) + rounding);
  result.products = lanczos.products();
  return result;
}

} // namespace

LargestFrequency largestFrequency(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                  const SharedNodeLists& shared, const View<const double*>& mass,
                                  const BodyTypes& types, ElementKind kind, double element_step) {
  if (!(element_step < HUGE_VAL))
    return {};
  Representatives bodies = representativesOf(space, comm, mesh, shared, mass, types);
  const double omega_square = 4 / (element_step * element_step);
  return kind == ElementKind::one_point
             ? converge<OnePointGeometry<double>>(space, comm, bodies, omega_square)
             : converge<FullGeometry<double>>(space, comm, bodies, omega_square);
}

} // namespace brickwall::mechanics
