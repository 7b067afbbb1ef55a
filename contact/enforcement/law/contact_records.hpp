// The contact history as records on the host, for restart files: every value that the next step or
// a report after a restart reads, with global ids in place of local numbers.
#pragma once

#include "contact/base/to_device.hpp"
#include "contact/enforcement/law/contact_history.hpp"

#include <functional>
#include <vector>

namespace brickwall::contact {

struct ContactRecord {
  global_id node = -1; // global id of the node (or edge) whose row this is
  // 0, or the number of steps since the last contact of a row that has none; then the record has no
  // interaction
  int steps_since = 0;
  Interaction pair; // without local numbers
  FrictionSpring friction; // zero without friction
  FadingForce fading; // zero where fade_weight is 1
};

// Calls visit(name, value) for every value of a record that a restart needs; a value is a double, a
// Vec3, an array of doubles, an int, a bool or a global_id.
template <class Record, class Visit>
void visitFields(Record& record, const Visit& visit) {
  visit("node", record.node);
  visit("steps_since", record.steps_since);
  auto& pair = record.pair;
  visit("side", pair.side);
  visit("face", pair.face);
  visit("offset", pair.offset);
  visit("depth", pair.depth);
  visit("stiffness", pair.stiffness);
  visit("fade_weight", pair.fade_weight);
  visit("stored", pair.stored);
  visit("force", pair.force);
  visit("damping", pair.damping);
  visit("closing", pair.closing);
  visit("normal", pair.normal);
  visit("weight", pair.weight);
  visit("first_force", pair.first_force);
  visit("share", pair.point.share);
  visit("is_retained", pair.is_retained);
  visit("is_new", pair.is_new);
  visit("settles", pair.settles);
  visit("first_damping", pair.first_damping);
  visit("inverse_mass", pair.inverse_mass);
  visit("friction_force", record.friction.force);
  visit("friction_trial", record.friction.trial);
  visit("friction_motion", record.friction.motion);
  visit("friction_stiffness", record.friction.stiffness);
  visit("friction_lever_0", record.friction.lever[0]);
  visit("friction_lever_1", record.friction.lever[1]);
  visit("fading_on_node", record.fading.on_node);
  visit("fading_on_corner", record.fading.normal.on_corner);
  visit("fading_on_end", record.fading.normal.on_end);
  visit("fading_work", record.fading.work);
  visit("fading_factor", record.fading.factor);
  visit("fading_work_to_end", record.fading.work_to_end);
}

// The area of a contact in a flush joint (JointAreas).
struct JointRecord {
  global_id node = -1, side = -1; // of the node, and of the opposing side
  double area = 0; // length^2
};

// What the enforcement of contact carries from step to step besides the coordinates.
struct ContactCarry {
  std::vector<ContactRecord> records; // of this rank's nodes (or edges)
  double previous_dt = 0; // of the last step, time
  bool has_forces = false; // on any rank in the last step
  std::vector<JointRecord> joints; // of this rank's nodes
};

// When the rows of a history last had contacts, which decides on settling (ContactLaw). With
// friction only; otherwise without rows.
struct LastContacts {
  View<int*> step; // [row] number of the step after its last contact, or 0
  int num_steps = 0; // done so far
};

// The contacts of this rank. `node_ids` are those of the surface whose nodes the history names.
std::vector<ContactRecord> recordsOf(const exec_space& space,
                                     const View<const global_id*>& node_ids,
                                     const ContactHistory& history, const LastContacts& last);

// Sets `history` and `last`, whose rows are nodes with these ids, to `records`. `pointOf` gives the
// pushing point of a row. Throws Error for a node that is not in `node_ids`.
void setHistory(const exec_space& space, const View<const global_id*>& node_ids,
                const std::vector<ContactRecord>& records, bool has_friction,
                const std::function<ContactPoint(int row)>& pointOf, ContactHistory& history,
                LastContacts& last);

} // namespace brickwall::contact
