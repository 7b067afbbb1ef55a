#include "contact/enforcement/law/contact_sums.hpp"

#include "contact/base/mpi.hpp"

namespace brickwall::contact {

std::string ContactSums::problem() const {
  if (invalid + terms.invalid > 0)
    return "contact forces or energies that are not finite or beyond the fixed-point range: " +
           std::to_string(invalid + terms.invalid);
  if (lost > 0)
    return "loaded contacts that are lost, since they are deeper than the search reaches or far "
           "beyond a bent edge of their face: " +
           std::to_string(lost) + " (largest penetration " + std::to_string(max_penetration) +
           " of a face's size among the others); increase contact.tolerance or contact.penalty";
  return "";
}

void sumOverRanks(MPI_Comm comm, ContactSums& sums) {
  constexpr int num_limbs = LimbSums<num_contact_terms>::size();
  std::int64_t counts[num_limbs + 5];
  for (int i = 0; i < num_limbs; ++i)
    counts[i] = sums.terms.data()[i];
  std::int64_t* rest = counts + num_limbs;
  rest[0] = sums.interactions, rest[1] = sums.active, rest[2] = sums.lost;
  rest[3] = sums.invalid, rest[4] = sums.penetrating;
  allReduce(comm, counts, num_limbs + 5, MPI_SUM);
  for (int i = 0; i < num_limbs; ++i)
    sums.terms.data()[i] = counts[i];
  sums.interactions = rest[0], sums.active = rest[1], sums.lost = rest[2];
  sums.invalid = rest[3], sums.penetrating = rest[4];
  sums.max_penetration = allReduce(comm, sums.max_penetration, MPI_MAX);
  sums.deepest = allReduce(comm, sums.deepest, MPI_MAX);
}

} // namespace brickwall::contact
