#include "mechanics/stable_time_step.hpp"

#include "contact/base/mpi.hpp"
#include "mechanics/material_tangent.hpp"
#include "mechanics/symmetric_eigenvalue.hpp"

#include <cmath>

namespace brickwall::mechanics {

namespace {

// Smallest dt and, of equals, the lowest global element id.
struct Smallest {
  double dt = HUGE_VAL;
  global_id elem = INT64_MAX;
  KOKKOS_INLINE_FUNCTION Smallest& operator+=(const Smallest& b) {
    if (b.dt < dt || (b.dt == dt && b.elem < elem)) {
      dt = b.dt;
      elem = b.elem;
    }
    return *this;
  }
};

StableTimeStep agree(MPI_Comm comm, const Smallest& local) {
  StableTimeStep result;
  result.dt = allReduce(comm, local.dt, MPI_MIN);
  const global_id none = INT64_MAX;
  const global_id elem = allReduce(comm, local.dt == result.dt ? local.elem : none, MPI_MIN);
  result.elem = elem == none ? -1 : elem;
  return result;
}

// The element's geometry as the bound needs it.
struct ElementShape {
  double b[num_modes][3]; // modes of the mean gradient
  Mat3 gram; // G
  double length; // l of bulk viscosity
  bool parallelepiped;
};
KOKKOS_INLINE_FUNCTION ElementShape shapeOf(const MeshViews& mesh, int elem,
                                            double (&corners)[8][3]) {
  ElementShape shape;
  double modes[3][num_modes];
  gatherCorners(mesh.elem_to_nodes, mesh.reference_coordinates, elem, corners);
  coordinateModes(corners, modes);
  meanGradientModes(modes, hexVolume(corners).volume, shape.b);
  shape.gram = gradientGram(shape.b);
  FullGeometry<double> geometry;
  coordinateModes(corners, geometry.X);
  shape.length = elementLength(geometry);
  double linear = 0, bent = 0;
  for (int j = 0; j < 3; ++j)
    for (int m = 0; m < num_modes; ++m) {
      double& largest = m < 3 ? linear : bent;
      largest = maxOf(largest, std::fabs(modes[j][m]));
    }
  shape.parallelepiped = bent <= 1e-9 * linear;
  return shape;
}

// The bound is exact on parallelepipeds; elsewhere hourglass modes couple in.
KOKKOS_INLINE_FUNCTION double stepOf(double omega_square, bool parallelepiped) {
  return (parallelepiped ? 2.0 : 2.0 * 0.98) / std::sqrt(omega_square);
}

// c = (8/rho) l rho c_d xi tr G, G of the present configuration: the viscous stress is proportional to tr D alone, so
// the element's C has this one eigenvalue.
KOKKOS_INLINE_FUNCTION double viscousRate(const StepViscosity& viscous, const Material& material,
                                          double length, double gram_trace) {
  const BulkViscosity& b = viscous.viscosity;
  const double xi = b.linear + b.quadratic * b.quadratic * viscous.rate;
  return 8 * length * material.dilatationalSpeed() * xi * gram_trace;
}

// The root of dt^2 omega^2/4 + dt c/2 = share^2 over the share; `step` is 2/omega.
KOKKOS_INLINE_FUNCTION double viscousStep(double step, double c, double share) {
  const double xi = 0.25 * c * step;
  return step * share / (xi + std::sqrt(xi * xi + share * share));
}

struct StepAtRest {
  MeshViews mesh;
  StepViscosity viscous;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t elem, Smallest& smallest) const {
    double X[8][3];
    const ElementShape shape = shapeOf(mesh, static_cast<int>(elem), X);
    const Material material = mesh.materials(mesh.elem_block(elem));
    double gram[3][3], eigenvalues[3], normal[3][3];
    for (int k = 0; k < 9; ++k)
      gram[k / 3][k % 3] = shape.gram(k / 3, k % 3);
    symmetricEigenvalues(gram, eigenvalues);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        normal[i][j] = (material.lambda() + (i == j ? 2 * material.mu() : 0.0)) *
                       std::sqrt(eigenvalues[i] * eigenvalues[j]);
    const double omega_square = 8 / material.density * largestEigenvalue(normal);
    double dt = stepOf(omega_square, shape.parallelepiped);
    if (viscous.viscosity.any())
      dt = viscousStep(dt,
                       viscousRate(viscous, material, shape.length,
                                   shape.gram(0, 0) + shape.gram(1, 1) + shape.gram(2, 2)),
                       viscous.share);
    smallest += Smallest{dt, mesh.elem_ids(elem)};
  }
};

// lambda_max of L^T A L with G = L L^T: the tangent dP/dH on the mean gradients (9x9).
KOKKOS_INLINE_FUNCTION double tangentEigenvalue(const double (&A)[9][9], const Mat3& gram) {
  double L[3][3], matrix[9][9];
  cholesky(gram, L);
  for (int i = 0; i < 3; ++i)
    for (int p = 0; p < 3; ++p)
      for (int k = 0; k < 3; ++k)
        for (int q = 0; q < 3; ++q) {
          double sum = 0;
          for (int j = 0; j < 3; ++j)
            for (int l = 0; l < 3; ++l)
              sum += L[j][p] * A[3 * i + j][3 * k + l] * L[l][q];
          matrix[3 * i + p][3 * k + q] = sum;
        }
  return largestEigenvalue(matrix);
}

// tr(F^-T G F^-1); of G itself for the small-strain material.
KOKKOS_INLINE_FUNCTION double deformedTrace(const double (&H)[3][3], const Mat3& gram,
                                            MaterialModel model) {
  double F[3][3], c[3][3], sum = 0;
  if (model == MaterialModel::linear)
    return gram(0, 0) + gram(1, 1) + gram(2, 2);
  deformationGradient(H, F);
  cofactors(F, c);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        sum += c[i][j] * gram(j, k) * c[i][k];
  const double J = 1 + volumeChange(H);
  return sum / (J * J);
}

struct StepAtDeformation {
  MeshViews mesh;
  StepViscosity viscous;
  View<const double* [3]> displacement;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t elem, Smallest& smallest) const {
    double X[8][3], u[8][3], modes[3][num_modes], H[3][3], A[9][9];
    const ElementShape shape = shapeOf(mesh, static_cast<int>(elem), X);
    gatherCorners(mesh.elem_to_nodes, displacement, static_cast<int>(elem), u);
    coordinateModes(u, modes);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        H[i][j] = 0;
        for (int m = 0; m < num_modes; ++m)
          H[i][j] += 0.125 * modes[i][m] * shape.b[m][j];
      }
    const Material material = mesh.materials(mesh.elem_block(elem));
    double dt = 0;
    if (materialTangent(H, material, A)) {
      dt = stepOf(8 / material.density * tangentEigenvalue(A, shape.gram), shape.parallelepiped);
      if (viscous.viscosity.any())
        dt = viscousStep(dt,
                         viscousRate(viscous, material, shape.length,
                                     deformedTrace(H, shape.gram, material.model)),
                         viscous.share);
    }
    smallest += Smallest{dt == dt ? dt : 0.0, mesh.elem_ids(elem)};
  }
};

} // namespace

StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const StepViscosity& viscous) {
  Smallest smallest;
  Kokkos::parallel_reduce("mechanics::stableTimeStep::at_rest", over(space, mesh.num_elems),
                          StepAtRest{viewsOf(mesh), viscous}, Combine<Smallest>(smallest));
  space.fence();
  return agree(comm, smallest);
}

StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const View<const double* [3]>& displacement,
                              const StepViscosity& viscous) {
  Smallest smallest;
  Kokkos::parallel_reduce("mechanics::stableTimeStep::deformed", over(space, mesh.num_elems),
                          StepAtDeformation{viewsOf(mesh), viscous, displacement},
                          Combine<Smallest>(smallest));
  space.fence();
  return agree(comm, smallest);
}

double contactStepShare(double safety, double penalty, double damping, bool edges) {
  // Weyl's bound, as forms relative to the mass: dt^2 K/4 + dt^2 K_c/4 + dt C/2 <= 1 with dt^2 K/4 = chi^2; contact adds
  // mult s/4 and, with C = 2 zeta sqrt(k m) taken at v^{n-1/2}, mult zeta sqrt(s). mult: how often a node's mass is pushed along
  // one direction.
  const double mult = edges ? 2.55 : 2.05; // two passes; crossing edges add half a node's stiffness
  constexpr double least = 0.01; // a tenth of the elements' step
  const double limit = 4 * (1 - least) / mult;
  if (!(safety > 0 && safety <= 1))
    throw InputError("contactStepShare: safety " + std::to_string(safety) +
                     "; a value in (0, 1] is needed");
  if (!(penalty >= 0 && penalty < limit))
    throw InputError("contactStepShare: penalty " + std::to_string(penalty) + "; a value in [0, " +
                     std::to_string(limit) + ") is needed" +
                     (edges ? ", with contact.edges = false more" : ""));
  if (!(damping >= 0))
    throw InputError("contactStepShare: damping " + std::to_string(damping) +
                     "; a value >= 0 is needed");
  const double left = 1 - 0.25 * mult * penalty - mult * damping * std::sqrt(penalty);
  if (!(left >= least))
    throw InputError(
        "contactStepShare: contact of penalty " + std::to_string(penalty) + " and damping " +
        std::to_string(damping) + " leaves no stable step of use; damping of at most " +
        std::to_string((1 - least - 0.25 * mult * penalty) / (mult * std::sqrt(penalty))) +
        " is needed");
  return std::min(safety, std::sqrt(left));
}

} // namespace brickwall::mechanics
