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

// The ghosts that are in use, chosen in each step. Values travel between these and their owners
// only, so ranks without contacts at their common boundary send each other nothing.
class GhostSelection {
public:
  // Collective among partners. Selects the ghosts of the last migration whose flags [ghost] are not
  // 0, and tells their owners.
  void select(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
              const FaceMigration& migration, const View<const unsigned char*>& flags);
  // As the functions above, for the selected ghosts, until the next migration.
  void forward(const exec_space& space, MPI_Comm comm, const View<const int* [4]>& face_to_nodes,
               const View<const double* [3]>& node_values, const View<double* [12]>& ghost_values);
  void reverseSum(const exec_space& space, MPI_Comm comm, const View<const int* [4]>& face_to_nodes,
                  const View<const std::int64_t* [12]>& ghost_values,
                  const View<std::int64_t* [3]>& node_values);

  // Own faces whose ghosts are selected; a face repeats if several ranks have selected it.
  const View<int*>& faces() const { return _faces; } // [place]; the View may be longer
  std::int64_t numFaces() const { return _num_faces; }

private:
  PartnerLists _ghosts; // selected, by owner
  View<int*> _faces{"contact::GhostSelection::faces", 0};
  std::int64_t _num_faces = 0;
  View<std::int64_t*> _before{"contact::GhostSelection::before", 0}; // [ghost] selected ones
  View<std::int64_t*> _starts{"contact::GhostSelection::starts", 0}; // [owner]
  PartnerMessages _messages; // to owners
};

} // namespace brickwall::contact
