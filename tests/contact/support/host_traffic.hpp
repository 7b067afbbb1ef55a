// Messages of a host code on its own communicator while the library works: receives of any message
// with any tag, or messages with the library's tags that nobody has received yet.
#pragma once

#include "contact/base/mpi.hpp"
#include "contact/base/tags.hpp"

#include <vector>

namespace brickwall::contact::test {

class HostTraffic {
public:
  enum Kind { pending_receives, pending_messages };

  // Collective.
  HostTraffic(MPI_Comm comm, Kind kind)
      : _comm(comm), _kind(kind), _size(sizeOf(comm)), _sent(_size * num_tags),
        _received(_size * num_tags) {
    kind == pending_receives ? postReceives() : postMessages();
    barrier(comm);
  }

  // Collective. Whether each message of the host has arrived as it was sent, and no other one.
  bool hasArrived() {
    _kind == pending_receives ? postMessages() : postReceives();
    bool is_right = true;
    for (std::size_t i = 0; i < _receives.size(); ++i) {
      MPI_Status status;
      checkMpi(MPI_Wait(&_receives[i], &status), "MPI_Wait");
      is_right = is_right && _received[i] == valueOf(status.MPI_SOURCE, status.MPI_TAG);
    }
    checkMpi(MPI_Waitall(static_cast<int>(_sends.size()), _sends.data(), MPI_STATUSES_IGNORE),
             "MPI_Waitall");
    return is_right;
  }

private:
  static constexpr int tag_numbers[] = {
      tags::shared_nodes,      tags::node_faces,      tags::node_boxes,  tags::face_migration,
      tags::ghost_reactions,   tags::node_box_counts, tags::face_counts, tags::corner_values,
      tags::ghost_coordinates, tags::by_rank};
  static constexpr int num_tags = sizeof tag_numbers / sizeof tag_numbers[0];

  static std::int64_t valueOf(int source, int tag) { return -1000 * source - tag; }

  void postReceives() {
    for (std::int64_t& value : _received) {
      _receives.emplace_back();
      checkMpi(
          MPI_Irecv(&value, 1, MPI_INT64_T, MPI_ANY_SOURCE, MPI_ANY_TAG, _comm, &_receives.back()),
          "MPI_Irecv");
    }
  }
  void postMessages() {
    for (int q = 0; q < _size; ++q)
      for (int t = 0; t < num_tags; ++t) {
        std::int64_t& value = _sent[q * num_tags + t];
        value = valueOf(rankOf(_comm), tag_numbers[t]);
        _sends.emplace_back();
        checkMpi(MPI_Isend(&value, 1, MPI_INT64_T, q, tag_numbers[t], _comm, &_sends.back()),
                 "MPI_Isend");
      }
  }

  MPI_Comm _comm;
  Kind _kind;
  int _size;
  std::vector<std::int64_t> _sent, _received;
  std::vector<MPI_Request> _sends, _receives;
};

} // namespace brickwall::contact::test
