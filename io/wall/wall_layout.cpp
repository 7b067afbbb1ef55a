// Geometry and numbering of the wall. All lengths are multiples of half an element edge plus
// multiples of the gap, so that nodes of neighbouring bricks that meet get the same bits from the
// same integers.
#include "io/wall/wall_layout.hpp"

#include "contact/base/error.hpp"

#include <cmath>

namespace brickwall::io {

namespace {

// Corner offsets of the Exodus hex8.
constexpr int corner_offset[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

std::int64_t checkedProduct(std::int64_t a, std::int64_t b) {
  std::int64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product))
    throw InputError("wall: found more entities than 64-bit ids can count");
  return product;
}

// Number of exterior faces of a brick with these numbers of elements.
std::int64_t countBrickFaces(const std::array<std::int64_t, 3>& n) {
  return 2 * (checkedProduct(n[0], n[1]) + checkedProduct(n[1], n[2]) + checkedProduct(n[0], n[2]));
}

void checkConfig(const WallConfig& config) {
  // Larger than any machine allows; sums of two counts cannot overflow.
  constexpr std::int64_t most = std::int64_t(1) << 40;
  for (int d = 0; d < 3; ++d) {
    if (config.bricks[d] < 1 || config.bricks[d] > most)
      throw InputError("wall: bricks[" + std::to_string(d) + "] is " +
                       std::to_string(config.bricks[d]) + ", must be from 1 to 2^40");
    if (config.elements[d] < 1 || config.elements[d] > most)
      throw InputError("wall: elements[" + std::to_string(d) + "] is " +
                       std::to_string(config.elements[d]) + ", must be from 1 to 2^40");
    if (!(config.brick[d] > 0) || !std::isfinite(config.brick[d]))
      throw InputError("wall: brick[" + std::to_string(d) + "] is " +
                       std::to_string(config.brick[d]) + ", must be a positive length");
  }
  if (!(config.gap >= 0) || !std::isfinite(config.gap))
    throw InputError("wall: gap is " + std::to_string(config.gap) + ", must not be negative");
  if (config.ends == WallEnds::flush && config.bricks[2] > 1) {
    if (config.elements[0] % 2 != 0)
      throw InputError("wall: elements[0] is " + std::to_string(config.elements[0]) +
                       ", but flush ends need an even number to halve a brick");
    if (config.gap >= config.brick[0])
      throw InputError("wall: gap " + std::to_string(config.gap) +
                       " leaves no half brick of length (brick[0] - gap) / 2");
  }
}

template <int N>
unsigned bitsOf(const bool (&flags)[N]) {
  unsigned bits = 0;
  for (int i = 0; i < N; ++i)
    bits |= static_cast<unsigned>(flags[i]) << i;
  return bits;
}

} // namespace

WallLayout::WallLayout(const WallConfig& config) : _config(config) {
  checkConfig(config);
  const auto& n = config.bricks;
  const auto& e = config.elements;
  const std::int64_t odd_courses = n[2] / 2, even_courses = n[2] - odd_courses;
  const bool flush = config.ends == WallEnds::flush;
  _num_whole = checkedProduct(checkedProduct(even_courses, n[1]), n[0]) +
               checkedProduct(checkedProduct(odd_courses, n[1]), flush ? n[0] - 1 : n[0]);
  _num_half = flush ? checkedProduct(checkedProduct(odd_courses, n[1]), 2) : 0;

  const auto elemsOf = [](std::int64_t ex, std::int64_t ey, std::int64_t ez) {
    return checkedProduct(checkedProduct(ex, ey), ez);
  };
  _elems_whole = elemsOf(e[0], e[1], e[2]);
  _elems_half = elemsOf(e[0] / 2, e[1], e[2]);
  _nodes_whole = elemsOf(e[0] + 1, e[1] + 1, e[2] + 1);
  _nodes_half = elemsOf(e[0] / 2 + 1, e[1] + 1, e[2] + 1);
  _faces_whole = countBrickFaces(e);
  _faces_half = countBrickFaces({e[0] / 2, e[1], e[2]});
  // An element has at most 8 nodes and 6 faces, and face ids are 6 elem + side: this bounds every
  // id.
  checkedProduct(checkedProduct(_num_whole + _num_half, _elems_whole), 16);
}

std::int64_t WallLayout::numElems() const {
  return _num_whole * _elems_whole + _num_half * _elems_half;
}
std::int64_t WallLayout::numNodes() const {
  return _num_whole * _nodes_whole + _num_half * _nodes_half;
}
std::int64_t WallLayout::numFaces() const {
  return _num_whole * _faces_whole + _num_half * _faces_half;
}

BrickPlace WallLayout::brickPlace(global_id brick) const {
  const auto& n = _config.bricks;
  BrickPlace place;
  if (brick >= _num_whole) { // half bricks: left and right of each odd course and wythe
    const std::int64_t half = brick - _num_whole;
    place.half = true;
    place.course = 2 * (half / (2 * n[1])) + 1;
    place.wythe = half % (2 * n[1]) / 2;
    place.first = half % 2 == 0;
    place.last = !place.first;
    place.along = place.first ? 0 : n[0];
    return place;
  }
  const bool flush = _config.ends == WallEnds::flush;
  const std::int64_t even_length = n[0], odd_length = flush ? n[0] - 1 : n[0];
  const std::int64_t pair = n[1] * (even_length + odd_length); // bricks of two courses
  std::int64_t rest = brick % pair;
  place.course = 2 * (brick / pair);
  const bool odd = rest >= n[1] * even_length;
  if (odd) {
    ++place.course;
    rest -= n[1] * even_length;
  }
  const std::int64_t length = odd ? odd_length : even_length;
  place.wythe = rest / length;
  place.along = rest % length;
  if (odd && flush) {
    ++place.along; // the half brick comes first
  } else {
    place.first = place.along == 0;
    place.last = place.along == length - 1;
  }
  return place;
}

std::array<std::int64_t, 3> WallLayout::brickElems(global_id brick) const {
  std::array<std::int64_t, 3> n = _config.elements;
  if (brick >= _num_whole)
    n[0] /= 2;
  return n;
}

global_id WallLayout::firstElem(global_id brick) const {
  const std::int64_t half = brick - _num_whole;
  return half <= 0 ? brick * _elems_whole : _num_whole * _elems_whole + half * _elems_half;
}
global_id WallLayout::firstNode(global_id brick) const {
  const std::int64_t half = brick - _num_whole;
  return half <= 0 ? brick * _nodes_whole : _num_whole * _nodes_whole + half * _nodes_half;
}
global_id WallLayout::brickOfElem(global_id elem) const {
  const std::int64_t in_half = elem - _num_whole * _elems_whole;
  return in_half < 0 ? elem / _elems_whole : _num_whole + in_half / _elems_half;
}
global_id WallLayout::brickOfNode(global_id node) const {
  const std::int64_t in_half = node - _num_whole * _nodes_whole;
  return in_half < 0 ? node / _nodes_whole : _num_whole + in_half / _nodes_half;
}

ElemPlace WallLayout::elemPlace(global_id elem) const {
  ElemPlace place;
  place.brick = brickOfElem(elem);
  const auto n = brickElems(place.brick);
  const std::int64_t local = elem - firstElem(place.brick);
  place.i = local % n[0];
  place.j = local / n[0] % n[1];
  place.k = local / n[0] / n[1];
  return place;
}

global_id WallLayout::elemId(const ElemPlace& place) const {
  const auto n = brickElems(place.brick);
  return firstElem(place.brick) + place.i + n[0] * (place.j + n[1] * place.k);
}

std::array<global_id, 8> WallLayout::elemNodes(global_id elem) const {
  const ElemPlace place = elemPlace(elem);
  const auto n = brickElems(place.brick);
  const global_id first = firstNode(place.brick);
  std::array<global_id, 8> nodes;
  for (int c = 0; c < 8; ++c) {
    const auto& d = corner_offset[c];
    nodes[c] =
        first + place.i + d[0] + (n[0] + 1) * (place.j + d[1] + (n[1] + 1) * (place.k + d[2]));
  }
  return nodes;
}

std::array<double, 3> WallLayout::elemCentroid(global_id elem) const {
  const auto nodes = elemNodes(elem);
  const auto lower = nodeCoordinates(nodes[0]), upper = nodeCoordinates(nodes[6]);
  return {0.5 * (lower[0] + upper[0]), 0.5 * (lower[1] + upper[1]), 0.5 * (lower[2] + upper[2])};
}

WallLayout::LocalNode WallLayout::localNode(global_id node) const {
  LocalNode at;
  at.brick = brickOfNode(node);
  const auto n = brickElems(at.brick);
  const std::int64_t local = node - firstNode(at.brick);
  at.i = local % (n[0] + 1);
  at.j = local / (n[0] + 1) % (n[1] + 1);
  at.k = local / (n[0] + 1) / (n[1] + 1);
  return at;
}

std::array<double, 3> WallLayout::nodeCoordinates(global_id node) const {
  const LocalNode at = localNode(node);
  const BrickPlace place = brickPlace(at.brick);
  const auto& e = _config.elements;
  const std::int64_t ex = e[0];

  // Along: half element edges, and half gaps before the brick; the elements of a half brick are
  // shorter by gap / ex each.
  const bool odd = place.course % 2 == 1;
  std::int64_t half_edges = 0;
  double gaps = 0;
  if (odd && _config.ends == WallEnds::flush) {
    const std::int64_t halves_before = place.first ? 0 : 2 * place.along - 1; // half bricks
    half_edges = halves_before * ex + 2 * at.i;
    gaps = 0.5 * static_cast<double>(halves_before);
    if (place.half)
      gaps -= static_cast<double>(at.i) / static_cast<double>(ex);
  } else {
    half_edges = (2 * place.along + (odd ? 1 : 0)) * ex + 2 * at.i;
    gaps = static_cast<double>(place.along) + (odd ? 0.5 : 0.0);
  }
  const auto at_lattice = [](std::int64_t steps, double brick, std::int64_t steps_per_brick,
                             double num_gaps, double gap) {
    return static_cast<double>(steps) * brick / static_cast<double>(steps_per_brick) +
           num_gaps * gap;
  };
  return {
      at_lattice(half_edges, _config.brick[0], 2 * ex, gaps, _config.gap),
      at_lattice(place.wythe * e[1] + at.j, _config.brick[1], e[1],
                 static_cast<double>(place.wythe), _config.gap),
      at_lattice(place.course * e[2] + at.k, _config.brick[2], e[2],
                 static_cast<double>(place.course), _config.gap),
  };
}

global_id WallLayout::faceId(std::int64_t face) const {
  const std::int64_t in_half = face - _num_whole * _faces_whole;
  ElemPlace place;
  place.brick = in_half < 0 ? face / _faces_whole : _num_whole + in_half / _faces_half;
  std::int64_t rest = in_half < 0 ? face % _faces_whole : in_half % _faces_half;
  const auto n = brickElems(place.brick);
  const std::int64_t faces_of_side[6] = {n[0] * n[2], n[1] * n[2], n[0] * n[2],
                                         n[1] * n[2], n[0] * n[1], n[0] * n[1]};
  int side = 0;
  while (rest >= faces_of_side[side])
    rest -= faces_of_side[side++];
  switch (side) {
  case 0:
  case 2:
    place.i = rest % n[0], place.j = side == 0 ? 0 : n[1] - 1, place.k = rest / n[0];
    break;
  case 1:
  case 3:
    place.i = side == 3 ? 0 : n[0] - 1, place.j = rest % n[1], place.k = rest / n[1];
    break;
  default:
    place.i = rest % n[0], place.j = rest / n[0], place.k = side == 4 ? 0 : n[2] - 1;
  }
  return elemId(place) * 6 + side;
}

unsigned WallLayout::wallSides(global_id elem) const {
  const ElemPlace at = elemPlace(elem);
  const auto n = brickElems(at.brick);
  const BrickPlace place = brickPlace(at.brick);
  bool is_on[num_wall_sides];
  is_on[wall_front] = place.wythe == 0 && at.j == 0;
  is_on[wall_back] = place.wythe == _config.bricks[1] - 1 && at.j == n[1] - 1;
  is_on[wall_left] = place.first && at.i == 0;
  is_on[wall_right] = place.last && at.i == n[0] - 1;
  is_on[wall_bottom] = place.course == 0 && at.k == 0;
  is_on[wall_top] = place.course == _config.bricks[2] - 1 && at.k == n[2] - 1;
  return bitsOf(is_on);
}

int WallLayout::hexSide(WallSide side) {
  constexpr int hex_side[num_wall_sides] = {0, 2, 3, 1, 4, 5};
  return hex_side[side];
}

unsigned WallLayout::nodeSets(global_id node) const {
  const LocalNode at = localNode(node);
  const BrickPlace place = brickPlace(at.brick);
  bool is_in[num_wall_node_sets];
  is_in[wall_base] = place.course == 0 && at.k == 0;
  is_in[wall_base_course] = place.course == 0;
  is_in[wall_top_course] = place.course == _config.bricks[2] - 1;
  is_in[wall_left_end] = place.first && at.i == 0;
  is_in[wall_right_end] = place.last && at.i == brickElems(at.brick)[0];
  return bitsOf(is_in);
}

std::vector<Block> WallLayout::blocks() const {
  std::vector<Block> blocks;
  if (_num_whole > 0)
    blocks.push_back({1, "brick", _num_whole * _elems_whole});
  if (_num_half > 0)
    blocks.push_back({2, "half_brick", _num_half * _elems_half});
  return blocks;
}

std::string WallLayout::sideSetName(WallSide side) {
  constexpr const char* names[num_wall_sides] = {"front", "back", "left", "right", "bottom", "top"};
  return names[side];
}
std::string WallLayout::nodeSetName(WallNodeSet set) {
  constexpr const char* names[num_wall_node_sets] = {"base", "base_course", "top_course",
                                                     "left_end", "right_end"};
  return names[set];
}

} // namespace brickwall::io
