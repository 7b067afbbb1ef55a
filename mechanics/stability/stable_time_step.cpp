#include "mechanics/stability/stable_time_step.hpp"

#include "contact/base/mpi.hpp"
#include "mechanics/mesh/recent_results.hpp"
#include "mechanics/stability/step_bounds.hpp"

#include <cmath>

namespace brickwall::mechanics {

namespace {

// Smallest dt of elements with, among equals, the lowest global element id, and the largest changes
// of the frequencies of whole bodies.
struct Limits {
  double dt = HUGE_VAL;
  global_id elem = INT64_MAX;
  double bare = HUGE_VAL; // dt without viscosity
  double viscous = 0; // c
  double growth = 0; // of omega^2
  double turn = 0; // theta
  KOKKOS_INLINE_FUNCTION Limits& operator+=(const Limits& b) {
    if (b.dt < dt || (b.dt == dt && b.elem < elem)) {
      dt = b.dt;
      elem = b.elem;
    }
    bare = minOf(bare, b.bare);
    viscous = maxOf(viscous, b.viscous);
    growth = maxOf(growth, b.growth);
    turn = maxOf(turn, b.turn);
    return *this;
  }
  // From `bare`, 2/omega of an element of lumped mass, and c and growth likewise, to the limits of
  // the element with the share `mass` of it, under contact.
  KOKKOS_INLINE_FUNCTION void applyLoad(double mass, const StabilityTerms& load) {
    viscous /= mass;
    growth /= mass;
    if (bare == HUGE_VAL)
      return;
    bare *= std::sqrt(mass);
    dt = loadedStep(bare, viscous, load);
    dt = dt == dt ? dt : 0.0;
    bare = loadedStep(bare, 0, load);
  }
};

StableTimeStep agree(MPI_Comm comm, const Limits& local) {
  StableTimeStep result;
  result.dt = allReduce(comm, local.dt, MPI_MIN);
  const global_id none = INT64_MAX;
  const global_id elem = allReduce(comm, local.dt == result.dt ? local.elem : none, MPI_MIN);
  result.elem = elem == none ? -1 : elem;
  return result;
}

// The step of whole bodies from the largest values over all ranks; 0 if it is not known to be
// longer than that of elements.
double stepOfBodies(double viscous, double growth_of_elements, double turn,
                    const StabilityTerms& load, const RestFrequency& rest) {
  if (!(rest.bodies < rest.elements))
    return 0;
  const double remaining = 1 - load.contact, growth = growth_of_elements / remaining;
  const double omega = std::sqrt(rest.bodies + growth) + turn * std::sqrt(rest.elements + growth);
  const double step = viscousStep(2 / omega, viscous / remaining);
  return step > 0 ? step : 0; // 0 for NaN
}
double stepOfBodies(MPI_Comm comm, const Limits& local, const StabilityTerms& load,
                    const RestFrequency& rest) {
  if (!(rest.bodies < rest.elements))
    return 0;
  double largest[3] = {local.viscous, local.growth, local.turn};
  allReduce(comm, largest, 3, MPI_MAX);
  return stepOfBodies(largest[0], largest[1], largest[2], load, rest);
}

KOKKOS_INLINE_FUNCTION void gatherModes(const MeshViews& mesh, const View<const double* [3]>& nodal,
                                        int elem, double (&modes)[3][num_modes]) {
  double corners[8][3];
  gatherCorners(mesh.elem_to_nodes, nodal, elem, corners);
  coordinateModes(corners, modes);
}

struct LimitsAtRest {
  MeshViews mesh;
  StabilityTerms load;

  // All that the limits of an element of lumped mass depend on.
  struct Input {
    double X[3][num_modes];
    std::int64_t block;
  };
  KOKKOS_INLINE_FUNCTION Input inputOf(int elem) const {
    Input input;
    gatherModes(mesh, mesh.reference_coordinates, elem, input.X);
    input.block = mesh.elem_block(elem);
    return input;
  }

  KOKKOS_INLINE_FUNCTION Limits of(int elem) const {
    const ElementShape shape = shapeOf(mesh, elem);
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
    Limits mine;
    if (load.viscosity.any())
      mine.viscous = viscousRate(load, material, shape.length,
                                 shape.gram(0, 0) + shape.gram(1, 1) + shape.gram(2, 2));
    mine.bare = stepOf(omega_square, shape.parallelepiped);
    return mine;
  }
};

// What is found at a deformation: the change of whole bodies by norms or by eigenvalues, the
// elements' own step, or both. An element that failed has the step 0 in any case.
enum class Sought { bodies_by_norms, bodies, elements, both };

struct LimitsAtDeformation {
  MeshViews mesh;
  StabilityTerms load;
  View<const double* [3]> displacement;
  Sought sought;

  struct Input {
    LimitsAtRest::Input at_rest;
    double u[3][num_modes];
  };
  KOKKOS_INLINE_FUNCTION Input inputOf(int elem) const {
    Input input;
    input.at_rest = LimitsAtRest{mesh, load}.inputOf(elem);
    gatherModes(mesh, displacement, elem, input.u);
    return input;
  }

  // 8/rho times an upper bound of the largest eigenvalue.
  KOKKOS_INLINE_FUNCTION double omegaSquare(const double (&A)[9][9], const Mat3& gram,
                                            double density) const {
    double matrix[9][9];
    onMeanGradients(A, gram, matrix);
    return 8 / density *
           (sought == Sought::bodies_by_norms ? largestRow(matrix) : largestEigenvalue(matrix));
  }

  KOKKOS_INLINE_FUNCTION Limits of(int elem) const {
    double modes[3][num_modes], H[3][3], A[9][9];
    const ElementShape shape = shapeOf(mesh, elem);
    gatherModes(mesh, displacement, elem, modes);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        H[i][j] = 0;
        for (int m = 0; m < num_modes; ++m)
          H[i][j] += 0.125 * modes[i][m] * shape.b[m][j];
      }
    const Material material = mesh.materials(mesh.elem_block(elem));
    Limits mine;
    if (!materialTangent(H, material, A)) {
      mine.bare = 0;
      mine.growth = HUGE_VAL;
      return mine;
    }
    if (load.viscosity.any())
      mine.viscous =
          viscousRate(load, material, shape.length, deformedTrace(H, shape.gram, material.model));
    if (sought == Sought::elements || sought == Sought::both)
      mine.bare = stepOf(omegaSquare(A, shape.gram, material.density), shape.parallelepiped);
    if (sought != Sought::elements) {
      double change[9][9];
      changeOfModuli(A, H, material, change);
      const double growth = maxOf(omegaSquare(change, shape.gram, material.density),
                                  hourglassGrowth(H, material, shape));
      mine.growth = growth == growth ? maxOf(growth, 0.0) : HUGE_VAL;
      mine.turn = turnOfCorners(modes, H, shape);
    }
    double trace = 0; // if positive, so is an eigenvalue, and the element has a step
    for (int k = 0; k < 9; ++k)
      trace += A[k][k];
    if (sought == Sought::bodies && !(trace > 0))
      mine.growth = HUGE_VAL;
    return mine;
  }
};

// The limits of elements [0, num_elems), which are worked out once for copies among neighbours.
template <class LimitsOf>
struct AddLimits {
  LimitsOf limits_of;
  std::int64_t num_elems;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t part, Limits& limits) const {
    RecentResults<typename LimitsOf::Input, Limits> recent;
    const std::int64_t end = minOf((part + 1) * items_per_memory, num_elems);
    for (std::int64_t e = part * items_per_memory; e < end; ++e) {
      const int elem = static_cast<int>(e);
      Limits mine = recent.find(limits_of.inputOf(elem), [&] { return limits_of.of(elem); });
      mine.applyLoad(limits_of.load.mass_shares.size() > 0 ? limits_of.load.mass_shares(elem) : 1.0,
                     limits_of.load);
      mine.elem = limits_of.mesh.elem_ids(elem);
      limits += mine;
    }
  }
};
template <class LimitsOf>
Limits sumOfLimits(const exec_space& space, const char* label, std::int64_t num_elems,
                   const LimitsOf& limits_of) {
  Limits limits;
  const std::int64_t parts = dividedUp(num_elems, items_per_memory);
  Kokkos::parallel_reduce(label, rangePolicy(space, parts),
                          AddLimits<LimitsOf>{limits_of, num_elems}, PlusReducer<Limits>(limits));
  return limits;
}

} // namespace

ElementsAtRest findElementsAtRest(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                  const StabilityTerms& load) {
  const Limits limits = sumOfLimits(space, "mechanics::findElementsAtRest::elements",
                                    mesh.num_elems, LimitsAtRest{viewsOf(mesh), load});
  return {agree(comm, limits), allReduce(comm, limits.bare, MPI_MIN),
          allReduce(comm, limits.viscous, MPI_MAX)};
}

StableTimeStep stableTimeStep(const ElementsAtRest& elements, const StabilityTerms& load,
                              const RestFrequency& rest) {
  StableTimeStep stable = elements.step;
  stable.dt = maxOf(stable.dt, stepOfBodies(elements.viscous, 0, 0, load, rest));
  return stable;
}

StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const StabilityTerms& load, const RestFrequency& rest) {
  return stableTimeStep(findElementsAtRest(space, comm, mesh, load), load, rest);
}

StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const View<const double* [3]>& displacement,
                              const StabilityTerms& load, const RestFrequency& rest,
                              double enough) {
  const auto limitsOf = [&](Sought sought, int num_elems) {
    return sumOfLimits(space, "mechanics::stableTimeStep::elements", num_elems,
                       LimitsAtDeformation{viewsOf(mesh), load, displacement, sought});
  };
  const bool is_for_bodies = rest.bodies < rest.elements;
  if (is_for_bodies) {
    StableTimeStep stable;
    const auto findStepOfBodies = [&](Sought sought) {
      return stable.dt = stepOfBodies(comm, limitsOf(sought, mesh.num_elems), load, rest);
    };
    if (enough < HUGE_VAL && findStepOfBodies(Sought::bodies_by_norms) >= enough)
      return stable;
    // If bodies allow a longer step than one element does, the others need not be known.
    const double of_one = limitsOf(Sought::elements, minOf(mesh.num_elems, 1)).dt;
    const double at_most = allReduce(comm, of_one, MPI_MIN);
    if (findStepOfBodies(Sought::bodies) >= at_most && stable.dt > 0)
      return stable;
  }
  const Limits limits = limitsOf(is_for_bodies ? Sought::both : Sought::elements, mesh.num_elems);
  StableTimeStep stable = agree(comm, limits);
  if (stable.dt > 0)
    stable.dt = maxOf(stable.dt, stepOfBodies(comm, limits, load, rest));
  return stable;
}

namespace {

constexpr double largest_mass_fraction = 0.99; // a tenth of the step is left

// The number of contacts that act on a node's mass along one direction: two passes; crossing edges
// add half a node's stiffness.
double contactsOnMass(bool edges) {
  return edges ? 2.55 : 2.05;
}

} // namespace

double contactMassFraction(double penalty, double damping, bool edges) {
  // In terms of forms relative to the mass: dt^2 K_c/4 + dt C_c/2 with C_c = 2 zeta sqrt(k m) at
  // v^{n-1/2}.
  if (!(damping >= 0))
    throw InputError("found contact.damping = " + std::to_string(damping) +
                     ", expected a value >= 0");
  if (!(penalty > 0 && penalty < largestPenalty(damping, edges)))
    throw InputError("found contact.penalty = " + std::to_string(penalty) +
                     ", expected a value above 0 and " + boundOfPenalty(damping, edges));
  return contactsOnMass(edges) * (0.25 * penalty + damping * std::sqrt(penalty));
}

std::string boundOfPenalty(double damping, bool edges) {
  return "below " + std::to_string(largestPenalty(damping, edges)) +
         (damping > 0 ? " with this contact.damping" : "") +
         (edges ? "; contact.edges = false allows more" : "");
}

double largestPenalty(double damping, bool edges) {
  return penaltyForMassFraction(4 * largest_mass_fraction / contactsOnMass(edges), damping);
}

double penaltyForMassFraction(double undamped, double damping) {
  // s/4 + zeta sqrt(s) = s_0/4
  const double root = 2 * (std::sqrt(damping * damping + 0.25 * undamped) - damping);
  return root * root;
}

View<double*> massUnderContact(const exec_space& space, const View<const double*>& mass,
                               const View<const int*>& surface_to_node, double contact_load) {
  auto reduced =
      allocate<View<double*>>(space, "mechanics::massUnderContact::mass", mass.extent(0));
  Kokkos::deep_copy(space, reduced, mass);
  Kokkos::parallel_for(
      "mechanics::massUnderContact::nodes", rangePolicy(space, surface_to_node.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t s) { reduced(surface_to_node(s)) *= 1 - contact_load; });
  return reduced;
}

} // namespace brickwall::mechanics
