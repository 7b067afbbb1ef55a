// Forces of elements in packs: arguments, sums and launch of the force kernels.
#pragma once

#include "contact/base/sum_over.hpp"
#include "mechanics/element/bulk_viscosity.hpp"
#include "mechanics/force/packs/element_tables.hpp"
#include "mechanics/mesh/element_failure.hpp"
#include "mechanics/mesh/nodal_state.hpp"

namespace brickwall::mechanics {

struct ForceArguments {
  ElementTables tables;
  View<const double* [3]> displacement;
  View<const double* [3]> velocity; // only with viscosity
  ForceColumns forces;
  BulkViscosity viscosity;
  double inverse_quantum;
  LimbScale energy_scale;
  int first_chunk;
  bool with_energy;
  bool skips_lattices;
  View<const int*> is_resting = {}; // [body]; empty if no body rests

  KOKKOS_INLINE_FUNCTION bool rests(int body) const {
    return is_resting.extent(0) > 0 && is_resting(body) != 0;
  }
};

struct ForceSums {
  LimbSums<num_stored_energies> energy;
  ElementFailure failure;
  double compression_rate = 0; // largest
  KOKKOS_INLINE_FUNCTION ForceSums& operator+=(const ForceSums& b) {
    energy += b.energy;
    failure += b.failure;
    compression_rate = maxOf(compression_rate, b.compression_rate);
    return *this;
  }
};

KOKKOS_INLINE_FUNCTION int failureReason(double J, double largest) {
  if (J <= 0)
    return inverted_element;
  if (J != J || largest != largest)
    return not_a_number;
  return fitsFixedPoint(largest) ? no_failure : force_overflow;
}

// Adds the forces of one group of chunks, and those of bulk viscosity if viscosity.any(). Not
// collective; a host waits.
void addPackForces(const exec_space& space, ElementKind kind, const ChunkGroup& group,
                   const ForceArguments& arguments, LaunchedSums<ForceSums>& sums);

} // namespace brickwall::mechanics
