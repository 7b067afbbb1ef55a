// One number for all that contacts remember: equal on any ranks and threads where every bit is.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"

#include "contact/base/backend.hpp"

namespace brickwall::contact {

// Sum modulo 2^64 of a hash of each interaction, by global ids, so in no order: what the next step reads of them, friction
// springs included. This rank's part: the sum over ranks does not depend on how bodies are cut. `node_ids` are those of the
// surface whose nodes the interactions name.
std::uint64_t historyChecksum(const exec_space& space, const View<const global_id*>& node_ids,
                              const ContactHistory& history);

} // namespace brickwall::contact
