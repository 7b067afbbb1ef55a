// Nodal values to the corners of the ghosts of a step, such as the accelerations that the energy-neutral contact needs.
#pragma once

#include "contact/face_migration.hpp"

namespace brickwall::contact {

// Collective among partners. ghost_values(ghost, 3 * corner + xyz) = the owner's node_values(its surface node, xyz).
// `faces_sent` as of the last migration; ghost_values has that many rows or more.
void sendCornerValues(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                      const View<const int* [4]>& face_to_nodes,
                      const View<const double* [3]>& node_values, FaceMigration& migration,
                      const View<double* [12]>& ghost_values);

} // namespace brickwall::contact
