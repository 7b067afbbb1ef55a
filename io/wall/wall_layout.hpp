// The brick wall as pure functions from global ids to geometry, so that no rank ever holds the
// whole mesh.
//
//   course 2   | brick | brick | brick |   axes: x along, y across (wythes), z up (courses)
//   course 1   |   | brick | brick |   |   flush ends: odd courses begin and end with a half brick
//   course 0   | brick | brick | brick |   ragged ends: odd courses are shifted by half a brick
//
// Ids are 0-based: whole bricks first (course by course, wythe by wythe, along x), then half
// bricks; elements and nodes brick by brick, i fastest, then j, then k. Each brick has nodes of its
// own.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::io {

enum class WallEnds { flush, ragged };

// `gap` separates neighbouring bricks in all three directions. With flush ends a half brick is
// (brick[0] - gap) / 2 long and has elements[0] / 2 elements, so that all courses have the same
// ends.
struct WallConfig {
  std::array<std::int64_t, 3> bricks = {8, 1, 10}; // along, across, courses
  std::array<double, 3> brick = {0.2, 0.1, 0.1}; // size of a whole brick, length
  std::array<std::int64_t, 3> elements = {8, 4, 4}; // per whole brick
  double gap = 0.0; // length
  WallEnds ends = WallEnds::flush;
};

// Random displacement of the nodes in `brickwall search`, so that coordinates of neighbouring
// bricks differ.
struct WallJitter {
  double amplitude = 0.0; // largest displacement along each axis, over the element edge
  std::uint64_t seed = 1;
};

// Place of a brick in the wall.
struct BrickPlace {
  std::int64_t course = 0, wythe = 0;
  std::int64_t along = 0; // position in its course, half bricks included
  bool half = false;
  bool first = false, last = false; // at the left, right end of its course
};

// Place of an element: its brick and its indices in the brick.
struct ElemPlace {
  global_id brick = 0;
  std::int64_t i = 0, j = 0, k = 0;
};

enum WallSide : int {
  wall_front,
  wall_back,
  wall_left,
  wall_right,
  wall_bottom,
  wall_top,
  num_wall_sides
};
enum WallNodeSet : int {
  wall_base, // nodes on z = 0
  wall_base_course, // all nodes of course 0
  wall_top_course, // all nodes of the last course
  wall_left_end, // nodes of the side set "left"
  wall_right_end, // nodes of the side set "right"
  num_wall_node_sets
};

class WallLayout {
public:
  // Throws InputError for an impossible wall: a count below 1, a size not finite and positive, a
  // negative gap, an odd number of elements along a brick that flush ends must halve, or more ids
  // than 64 bits hold.
  explicit WallLayout(const WallConfig& config);

  const WallConfig& config() const { return _config; }

  std::int64_t numBricks() const { return _num_whole + _num_half; }
  std::int64_t numWholeBricks() const { return _num_whole; }
  std::int64_t numHalfBricks() const { return _num_half; }
  std::int64_t numElems() const;
  std::int64_t numNodes() const;
  std::int64_t numFaces() const; // exterior faces of all bricks

  BrickPlace brickPlace(global_id brick) const;
  // Elements of a brick along each axis.
  std::array<std::int64_t, 3> brickElems(global_id brick) const;
  global_id firstElem(global_id brick) const;
  global_id firstNode(global_id brick) const;
  global_id brickOfElem(global_id elem) const;
  global_id brickOfNode(global_id node) const;

  ElemPlace elemPlace(global_id elem) const;
  global_id elemId(const ElemPlace& place) const;
  // Corner nodes in Exodus hex8 order.
  std::array<global_id, 8> elemNodes(global_id elem) const;
  std::array<double, 3> elemCentroid(global_id elem) const;
  // Reference coordinates. Nodes of neighbouring bricks that meet (gap 0) have the same bits.
  std::array<double, 3> nodeCoordinates(global_id node) const;

  // Exterior faces are numbered 0 .. numFaces() - 1 brick by brick; the face id is element id * 6 +
  // side (0-based).
  global_id faceId(std::int64_t face) const;

  // Bit s: a side of the element lies on WallSide s of the wall; the side is hexSide(s) (0-based).
  unsigned wallSides(global_id elem) const;
  static int hexSide(WallSide side);
  // Bit s: the node is in WallNodeSet s.
  unsigned nodeSets(global_id node) const;

  // Names and order of blocks ("brick", and "half_brick" if there are any), side sets and node
  // sets.
  std::vector<Block> blocks() const;
  static std::string sideSetName(WallSide side);
  static std::string nodeSetName(WallNodeSet set);

private:
  struct LocalNode {
    global_id brick;
    std::int64_t i, j, k;
  };
  LocalNode localNode(global_id node) const;

  WallConfig _config;
  std::int64_t _num_whole = 0, _num_half = 0;
  std::int64_t _elems_whole = 0, _elems_half = 0; // per brick
  std::int64_t _nodes_whole = 0, _nodes_half = 0;
  std::int64_t _faces_whole = 0, _faces_half = 0;
};

} // namespace brickwall::io
