// Nodal values to the corners of the ghosts: coordinates of ghosts that are kept over steps, and values such as the
// accelerations that the energy-neutral contact needs.
#pragma once

#include "contact/search/exchange/face_migration.hpp"

namespace brickwall::contact {

// Collective among partners, as is the next; one message per partner, `faces_sent` as of the last migration.
// ghost_values(ghost, 3 * corner + xyz) = the owner's node_values(its surface node, xyz); ghost_values has a row for each
// ghost or more.
void forwardCornerValues(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                         const View<const int* [4]>& face_to_nodes,
                         const View<const double* [3]>& node_values, FaceMigration& migration,
                         const View<double* [12]>& ghost_values);

// x^n and x^{n+1} of the owners' surfaces to migration.ghosts.
void sendCoordinates(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                     const Surface& surface, FaceMigration& migration);

} // namespace brickwall::contact
