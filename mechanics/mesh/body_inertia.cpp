#include "mechanics/mesh/body_inertia.hpp"

#include "contact/base/group_by_key.hpp"
#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/mesh/host_mesh.hpp"
#include "mechanics/mesh/mass_correction.hpp"
#include "mechanics/mesh/recent_results.hpp"
#include "mechanics/mesh/sum_by_body.hpp"

#include <algorithm>

namespace brickwall::mechanics {

namespace {

// Nodes by the first row of their body.
struct NodesByBody {
  View<int*> nodes;
  std::vector<BodyChunk> chunks;
};
NodesByBody groupNodes(const exec_space& space, const HexMesh& mesh) {
  const auto num_rows = static_cast<int>(mesh.bodies.size());
  const std::vector<int> row_of_node = bodyOfNodes(space, mesh, firstRows(mesh));
  const int* const rows = row_of_node.data();
  const Groups groups = groupByKey("mechanics::massWithInertia::nodes", mesh.num_nodes,
                                   num_rows + 1, [rows](std::int64_t node) { return rows[node]; });
  NodesByBody result;
  result.nodes = toDevice(space, "mechanics::massWithInertia::nodes", groups.items);
  for (int row = 0; row < num_rows; ++row)
    cut(groups.begin[row], groups.begin[row + 1] - groups.begin[row], row, result.chunks);
  return result;
}

// Bounding box and largest nodal mass of a body, the units of its sums.
struct Extent {
  Vec3 low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  double mass = 0;
  KOKKOS_INLINE_FUNCTION Extent& operator+=(const Extent& b) {
    for (int i = 0; i < 3; ++i) {
      low[i] = minOf(low[i], b.low[i]);
      high[i] = maxOf(high[i], b.high[i]);
    }
    mass = maxOf(mass, b.mass);
    return *this;
  }
};
struct AddExtents {
  View<const int*> nodes;
  View<const double* [3]> X;
  View<const double*> mass;
  KOKKOS_INLINE_FUNCTION void operator()(const BodyChunk& chunk, Extent& sum) const {
    for (int i = chunk.first; i < chunk.first + chunk.count; ++i) {
      const Vec3 x = rowOf(X, nodes(i));
      sum += Extent{x, x, mass(nodes(i))};
    }
  }
};

// Coordinates y of a body: its centre is the origin, its second moments are those of the unit
// matrix, and its mass is 1.
struct BodyFrame {
  Vec3 origin, centre; // the middle of the box; from there to the centre, over the radius
  double inverse_radius = 0, inverse_mass = 0;
  Mat3 whitening; // lower triangle

  KOKKOS_INLINE_FUNCTION Vec3 scaled(const Vec3& x) const { return inverse_radius * (x - origin); }
  KOKKOS_INLINE_FUNCTION Vec3 toBody(const Vec3& x) const {
    return whitening * (scaled(x) - centre);
  }
};
BodyFrame unitsOf(const Extent& extent) {
  BodyFrame frame;
  frame.origin = 0.5 * (extent.low + extent.high);
  frame.inverse_radius = 2 / norm(extent.high - extent.low);
  frame.inverse_mass = 1 / extent.mass;
  return frame;
}

// Moments of an element of unit density about the mean of its corners, by 3x3x3 Gauss quadrature
// (exact).
struct ElementMoments {
  double values[num_moments] = {};
};
KOKKOS_INLINE_FUNCTION ElementMoments momentsOf(const double (&X)[3][num_modes]) {
  ElementMoments moments;
  constexpr double root = 0.77459666924148337704; // sqrt(3/5)
  for (int point = 0; point < 27; ++point) {
    const int place[3] = {point % 3 - 1, point / 3 % 3 - 1, point / 9 - 1};
    double xi[3], weight = 1, gradient[num_modes][3], q[num_moments];
    for (int k = 0; k < 3; ++k) {
      xi[k] = root * place[k];
      weight *= (place[k] == 0 ? 8 : 5) / 9.0;
    }
    modeGradients(xi, gradient);
    weight *= determinant(jacobianAt(X, gradient));
    const double psi[num_modes] = {
        xi[0], xi[1], xi[2], xi[1] * xi[2], xi[2] * xi[0], xi[0] * xi[1], xi[0] * xi[1] * xi[2]};
    Vec3 x;
    for (int j = 0; j < 3; ++j)
      for (int m = 0; m < num_modes; ++m)
        x[j] += 0.125 * X[j][m] * psi[m];
    monomials(x, q);
    for (int a = 0; a < num_moments; ++a)
      moments.values[a] += weight * q[a];
  }
  return moments;
}

using Moments = LimbSums<num_moments>;
// Terms are at most those of an element of eight times the largest nodal mass in the unit sphere.
inline LimbScale momentScale() {
  return LimbScale::forLargest(64);
}
struct AddMoments {
  MeshViews mesh;
  View<const BodyFrame*> frames;
  LimbScale scale;

  struct Input {
    double X[3][num_modes];
  };

  KOKKOS_INLINE_FUNCTION void operator()(const BodyChunk& chunk, Moments& sum) const {
    const BodyFrame frame = frames(chunk.row);
    RecentResults<Input, ElementMoments> recent;
    for (int elem = chunk.first; elem < chunk.first + chunk.count; ++elem) {
      CornerCoordinates corners;
      Input input;
      gatherCorners(mesh.elem_to_nodes, mesh.reference_coordinates, elem, corners);
      coordinateModes(corners, input.X);
      const ElementMoments own = recent.find(input, [&] { return momentsOf(input.X); });
      addShifted(own, mesh.materials(mesh.elem_block(elem)).density, corners, frame, sum);
    }
  }

  KOKKOS_INLINE_FUNCTION void addShifted(const ElementMoments& own, double density,
                                         const CornerCoordinates& X, const BodyFrame& frame,
                                         Moments& sum) const {
    Vec3 mean;
    for (int c = 0; c < 8; ++c)
      mean += 0.125 * Vec3{X[c][0], X[c][1], X[c][2]};
    const Vec3 x = frame.scaled(mean);
    const double r = frame.inverse_radius, factor = frame.inverse_mass * density;
    const double mass = factor * own.values[0], unit = factor * r;
    const Vec3 first = {unit * own.values[1], unit * own.values[2], unit * own.values[3]};
    sum.add(0, mass, scale);
    for (int i = 0; i < 3; ++i)
      sum.add(1 + i, first[i] + mass * x[i], scale);
    for (int a = 0; a < num_quadratic; ++a) {
      const auto [i, j] = factorsOf(a);
      sum.add(num_linear + a,
              unit * r * own.values[num_linear + a] + first[i] * x[j] + x[i] * first[j] +
                  mass * x[i] * x[j],
              scale);
    }
  }
};

// Completes the frame with the body's mass, centre and second moments.
void complete(const Moments& moments, BodyFrame& frame) {
  double m[num_moments];
  for (int a = 0; a < num_moments; ++a)
    m[a] = moments.sum[a].value(momentScale());
  frame.inverse_mass /= m[0];
  frame.centre = {m[1] / m[0], m[2] / m[0], m[3] / m[0]};
  Mat3 second;
  for (int a = 0; a < num_quadratic; ++a) {
    const auto [i, j] = factorsOf(a);
    second(i, j) = second(j, i) = m[num_linear + a] / m[0] - frame.centre[i] * frame.centre[j];
  }
  double L[3][3];
  cholesky(second, L);
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i) { // L^-1 by columns
      double sum = i == j ? 1 : 0;
      for (int k = j; k < i; ++k)
        sum -= L[i][k] * frame.whitening(k, j);
      frame.whitening(i, j) = sum / L[i][i];
    }
}

struct AddNodes {
  View<const int*> nodes;
  View<const double* [3]> X;
  View<const double*> mass;
  View<const unsigned char*> is_owned;
  View<const BodyFrame*> frames;
  LimbScale scale;

  KOKKOS_INLINE_FUNCTION void operator()(const BodyChunk& chunk, NodeSums& sum) const {
    const BodyFrame frame = frames(chunk.row);
    for (int i = chunk.first; i < chunk.first + chunk.count; ++i)
      if (is_owned(nodes(i)))
        addNode(frame.toBody(rowOf(X, nodes(i))), frame.inverse_mass * mass(nodes(i)), sum);
  }
  KOKKOS_INLINE_FUNCTION void addNode(const Vec3& y, double mu, NodeSums& sum) const {
    double q[num_moments], powers[3][max_degree + 1];
    monomials(y, q);
    for (int a = 0; a < num_moments; ++a)
      sum.add(a, mu * q[a], scale);
    for (int j = 0; j < 3; ++j) {
      powers[j][0] = 1;
      for (int p = 1; p <= max_degree; ++p)
        powers[j][p] = powers[j][p - 1] * y[j];
    }
    forEachProduct([&](int n, int i, int j, int k) {
      sum.add(num_moments + n, mu * mu * (powers[0][i] * powers[1][j] * powers[2][k]), scale);
    });
  }
};

struct Least {
  double share = HUGE_VAL;
  KOKKOS_INLINE_FUNCTION Least& operator+=(const Least& b) {
    share = minOf(share, b.share);
    return *this;
  }
};

// The share of the quadratic change at which the lightest node keeps `least_mass_share`.
struct AddTaken {
  View<const int*> nodes;
  View<const double* [3]> X;
  View<const double*> mass;
  View<const BodyFrame*> frames;
  View<const Correction*> corrections;
  KOKKOS_INLINE_FUNCTION void operator()(const BodyChunk& chunk, Least& sum) const {
    const BodyFrame frame = frames(chunk.row);
    const Correction correction = corrections(chunk.row);
    for (int i = chunk.first; i < chunk.first + chunk.count; ++i) {
      const auto change =
          correction.partsAt(frame.toBody(rowOf(X, nodes(i))), frame.inverse_mass * mass(nodes(i)));
      const double reserve = 1 + change.linear - least_mass_share;
      if (reserve + change.quadratic < 0)
        sum += Least{maxOf(0.0, -reserve / change.quadratic)};
    }
  }
};

// Sets the masses and finds their least share of the lumped ones.
struct CorrectMasses {
  View<const int*> nodes;
  View<const double* [3]> X;
  View<const double*> lumped;
  View<const BodyFrame*> frames;
  View<const Correction*> corrections;
  View<double*> mass;
  KOKKOS_INLINE_FUNCTION void operator()(const BodyChunk& chunk, Least& sum) const {
    const BodyFrame frame = frames(chunk.row);
    const Correction correction = corrections(chunk.row);
    for (int i = chunk.first; i < chunk.first + chunk.count; ++i) {
      const int node = nodes(i);
      const auto change =
          correction.partsAt(frame.toBody(rowOf(X, node)), frame.inverse_mass * lumped(node));
      double share = 1 + change.linear + correction.taken * change.quadratic;
      if (!(share >= least_mass_share)) // a NaN keeps the lumped mass
        share = share == share ? least_mass_share : 1;
      mass(node) = share * lumped(node);
      sum += Least{share};
    }
  }
};

} // namespace

BodyMass massWithInertia(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                         const View<const double*>& lumped) {
  const View<const double* [3]> X = mesh.reference_coordinates;
  const NodesByBody grouped = groupNodes(space, mesh);
  const View<const int*> nodes = grouped.nodes;
  const std::size_t num_rows = mesh.bodies.size();
  std::vector<BodyChunk> elements;
  for (std::size_t row = 0; row < num_rows; ++row)
    cut(mesh.bodies[row].first, mesh.bodies[row].count, static_cast<int>(row), elements);

  std::vector<BodyFrame> frames;
  for (const Extent& extent : sumByBody<Extent>(space, comm, "mechanics::massWithInertia::extent",
                                                mesh, grouped.chunks, AddExtents{nodes, X, lumped}))
    frames.push_back(unitsOf(extent));
  const auto framesOnDevice = [&] {
    return toDevice(space, "mechanics::massWithInertia::frames", frames);
  };
  const auto moments =
      sumByBody<Moments>(space, comm, "mechanics::massWithInertia::moments", mesh, elements,
                         AddMoments{viewsOf(mesh), framesOnDevice(), momentScale()});
  for (std::size_t row = 0; row < num_rows; ++row)
    complete(moments[row], frames[row]);
  const View<const BodyFrame*> final_frames = framesOnDevice();

  const auto sums = sumByBody<NodeSums>(
      space, comm, "mechanics::massWithInertia::products", mesh, grouped.chunks,
      AddNodes{nodes, X, lumped, mesh.node_is_owned, final_frames, nodeScale()});
  std::vector<Correction> corrections(num_rows);
  parallelOnHost("mechanics::massWithInertia::solve", static_cast<std::int64_t>(num_rows),
                 [&](std::int64_t row) { corrections[row] = correctionOf(sums[row]); });
  const auto correctionsOnDevice = [&] {
    return toDevice(space, "mechanics::massWithInertia::corrections", corrections);
  };
  const auto taken =
      sumByBody<Least>(space, comm, "mechanics::massWithInertia::taken", mesh, grouped.chunks,
                       AddTaken{nodes, X, lumped, final_frames, correctionsOnDevice()});
  for (std::size_t row = 0; row < num_rows; ++row)
    corrections[row].taken = minOf(taken[row].share, 1.0);

  BodyMass result;
  result.mass = View<double*>("mechanics::massWithInertia::mass", mesh.num_nodes);
  const auto least = sumByBody<Least>(
      space, comm, "mechanics::massWithInertia::correct", mesh, grouped.chunks,
      CorrectMasses{nodes, X, lumped, final_frames, correctionsOnDevice(), result.mass});
  std::vector<double> shares = hostArray<double>(mesh.num_elems);
  parallelOnHost("mechanics::massWithInertia::least_shares", static_cast<std::int64_t>(num_rows),
                 [&](std::int64_t row) {
                   std::fill_n(shares.begin() + mesh.bodies[row].first, mesh.bodies[row].count,
                               least[row].share);
                 });
  result.least_shares = toDevice(space, "mechanics::massWithInertia::least_shares", shares);
  return result;
}

} // namespace brickwall::mechanics
