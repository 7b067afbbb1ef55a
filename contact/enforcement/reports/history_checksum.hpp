// Checksum of the contact history: equal on any number of ranks and threads if every bit is equal.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"

#include "contact/base/backend.hpp"

namespace brickwall::contact {

// Sum modulo 2^64 of a hash of each interaction, independent of the order: all its values that the
// next step reads, friction springs included, with global ids, but not LastContacts. This is the
// part of this rank; the sum over ranks does not depend on the partition. `node_ids` are those of
// the surface whose nodes the interactions name.
std::uint64_t historyChecksum(const exec_space& space, const View<const global_id*>& node_ids,
                              const ContactHistory& history);

} // namespace brickwall::contact
