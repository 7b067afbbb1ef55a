// Failures of elements, reduced to a count, the lowest global element id and its reason, and agreed
// over ranks.
#pragma once

#include "contact/base/error.hpp"
#include "contact/base/vec3.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

#include <string>

namespace brickwall::mechanics {

enum FailureReason : int {
  no_failure,
  inverted_element,
  not_a_number,
  force_overflow,
  mass_out_of_range
};

// Reduced with PlusReducer<ElementFailure>: counts add, the lowest global id is kept.
struct ElementFailure {
  std::int64_t count = 0;
  global_id first_elem = INT64_MAX; // global id
  int reason = no_failure; // reason of first_elem

  KOKKOS_INLINE_FUNCTION void add(global_id elem, int why) {
    ++count;
    if (elem < first_elem) {
      first_elem = elem;
      reason = why;
    }
  }
  KOKKOS_INLINE_FUNCTION ElementFailure& operator+=(const ElementFailure& b) {
    count += b.count;
    if (b.first_elem < first_elem) {
      first_elem = b.first_elem;
      reason = b.reason;
    }
    return *this;
  }
};

// The agreed failure, equal on every rank.
struct GlobalFailure {
  std::int64_t count = 0;
  global_id first_elem = -1;
  int reason = no_failure;
  Vec3 position; // mean of the reference coordinates of the first element's corners
};

// Agrees on the first failed element of all ranks. Collective; called only after the step's
// all-reduce (EnergyLedger::bookStep) has found a failure.
GlobalFailure agreeOnFailure(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                             const ElementFailure& local);

// What has failed, to follow the name of the first element: for example "at (x, y, z): inverted (J
// <= 0); failed elements: 3".
std::string describe(const GlobalFailure& failure);

// An element of the mesh is refused. Thrown on all ranks.
struct BadElementError : InputError {
  // `the_fault` follows the name of the element.
  BadElementError(global_id the_elem, const std::string& the_fault)
      : InputError("element " + std::to_string(the_elem) + " " + the_fault), elem(the_elem),
        fault(the_fault) {}
  global_id elem;
  std::string fault;
};

} // namespace brickwall::mechanics
