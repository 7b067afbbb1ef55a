// Values at the corners of the ghosts: from the nodes of their owners (forward) and back to them
// (reverseSum). One message per partner; `faces_sent` are those of the last migration.
#pragma once

#include "contact/search/exchange/face_migration.hpp"

namespace brickwall::contact {

// Collective among partners. ghost_values(ghost, 3 * corner + xyz) = node_values(surface node of
// the owner, xyz); ghost_values has a row for each ghost or more.
void forward(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
             const View<const int* [4]>& face_to_nodes, const View<const double* [3]>& node_values,
             FaceMigration& migration, const View<double* [12]>& ghost_values);

// Collective among partners. Copies x^n and x^{n+1} of the owners' surfaces to migration.ghosts.
void forwardCoordinates(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                        const SweptBoxes& surface, FaceMigration& migration);

// Collective among partners. node_values(corner j of the face, :) += ghost_values(ghost, 3 * j + :)
// for all ghosts of own faces.
void reverseSum(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                const View<const int* [4]>& face_to_nodes,
                const View<const std::int64_t* [12]>& ghost_values, FaceMigration& migration,
                const View<std::int64_t* [3]>& node_values);

} // namespace brickwall::contact
