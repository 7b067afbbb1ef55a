// The areas of contacts in flush joints as records on the host, for restart files.
#pragma once

#include "contact/enforcement/law/contact_records.hpp"
#include "contact/enforcement/node_face/joint_areas.hpp"

namespace brickwall::contact {

// The records of this rank's nodes, whose global ids are `node_ids`.
std::vector<JointRecord> recordsOf(const exec_space& space, const View<const global_id*>& node_ids,
                                   const JointAreas& joints);

// The areas of nodes with these ids; empty without records. Records of other nodes are ignored.
JointAreas jointAreasOf(const exec_space& space, const View<const global_id*>& node_ids,
                        std::vector<JointRecord> records);

} // namespace brickwall::contact
