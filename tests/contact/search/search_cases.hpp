// Random contact surfaces for the search tests, the same on every rank. They use nothing of the
// search but its data types.
#pragma once

#include "contact/base/messages/exchange_plan.hpp"
#include "contact/surface/surface.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace brickwall::contact::test {

using Point = std::array<double, 3>;

struct CaseNode {
  global_id id = 0, body = 0;
  Point x_old{}, x_new{};
  int owner = 0;
  std::vector<int> sharers; // ranks that have the node, ascending
};

struct CaseFace {
  global_id id = 0, body = 0;
  std::array<int, 4> corners{}; // indices into nodes
  int rank = 0;
};

// The whole surface of all ranks.
struct SurfaceCase {
  std::string kind;
  std::uint64_t seed = 0;
  std::vector<CaseNode> nodes;
  std::vector<CaseFace> faces;
  double node_tolerance = 0, face_tolerance = 0;
  bool drop_same_body = false;
  bool shuffled = false; // local order is not that of global ids

  std::string name() const { return kind + ", seed " + std::to_string(seed); }
};

// Numbers that are the same with every standard library.
class Random {
public:
  explicit Random(std::uint64_t seed) : _engine(seed * 0x9e3779b97f4a7c15u + 1) {}
  int below(int n) { return static_cast<int>(_engine() % static_cast<std::uint64_t>(n)); }
  double real(double from, double to) {
    return from + (to - from) * (static_cast<double>(_engine() >> 11) * 0x1p-53);
  }
  bool chance(double p) { return real(0, 1) < p; }
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i)
      std::swap(values[i - 1], values[static_cast<std::size_t>(below(static_cast<int>(i)))]);
  }

private:
  std::mt19937_64 _engine;
};

inline int addNode(SurfaceCase& c, global_id body, const Point& x) {
  CaseNode node;
  node.id = 3 * static_cast<global_id>(c.nodes.size()) + 5;
  node.body = body;
  node.x_old = node.x_new = x;
  c.nodes.push_back(node);
  return static_cast<int>(c.nodes.size()) - 1;
}
inline void addFace(SurfaceCase& c, global_id body, const std::array<int, 4>& corners) {
  CaseFace face;
  face.id = 7 * static_cast<global_id>(c.faces.size()) + 2;
  face.body = body;
  face.corners = corners;
  c.faces.push_back(face);
}

// The skin of a brick of n[0] x n[1] x n[2] cells between two points.
inline void addBrick(SurfaceCase& c, global_id body, const Point& lower, const Point& upper,
                     const std::array<int, 3>& n) {
  std::vector<int> index(static_cast<std::size_t>((n[0] + 1) * (n[1] + 1) * (n[2] + 1)), -1);
  const auto node = [&](std::array<int, 3> at) {
    int& entry = index[static_cast<std::size_t>(at[0] + (n[0] + 1) * (at[1] + (n[1] + 1) * at[2]))];
    if (entry < 0) {
      Point x;
      for (int d = 0; d < 3; ++d)
        x[d] = lower[d] + (upper[d] - lower[d]) * at[d] / n[d];
      entry = addNode(c, body, x);
    }
    return entry;
  };
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const int u = (d + 1) % 3, v = (d + 2) % 3;
      for (int i = 0; i < n[u]; ++i)
        for (int j = 0; j < n[v]; ++j) {
          std::array<int, 4> corners{};
          const int du[4] = {0, 1, 1, 0}, dv[4] = {0, 0, 1, 1};
          for (int k = 0; k < 4; ++k) {
            std::array<int, 3> at{};
            at[d] = side * n[d];
            at[u] = i + du[side == 1 ? k : 3 - k];
            at[v] = j + dv[side == 1 ? k : 3 - k];
            corners[k] = node(at);
          }
          addFace(c, body, corners);
        }
    }
}

inline void moveNodes(SurfaceCase& c, Random& random, double jitter, double step) {
  for (auto& node : c.nodes)
    for (int d = 0; d < 3; ++d) {
      node.x_old[d] += random.real(-jitter, jitter);
      node.x_new[d] = node.x_old[d] + random.real(-step, step);
    }
}

// Running bond with no gaps.
inline void addWall(SurfaceCase& c, Random& random, int n) {
  const int along = 2 + random.below(3), courses = 1 + random.below(3);
  for (int course = 0; course < courses; ++course)
    for (int i = 0; i < along; ++i) {
      const double x = 2.0 * i + course % 2;
      addBrick(c, course * along + i, {x, 0, 1.0 * course}, {x + 2, 1, course + 1.0},
               {2 * n, n, n});
    }
}

// Separate quadrilaterals; `place` gives the corners.
template <class Place>
void addQuads(SurfaceCase& c, int num_quads, int num_bodies, Random& random, const Place& place) {
  for (int q = 0; q < num_quads; ++q) {
    const global_id body = random.below(num_bodies);
    std::array<int, 4> corners{};
    for (int k = 0; k < 4; ++k)
      corners[k] = addNode(c, body, place(q, k));
    if (random.chance(0.2))
      corners[3] = corners[2]; // a triangle
    addFace(c, body, corners);
  }
}

inline void buildKind(SurfaceCase& c, Random& random, int kind) {
  switch (kind) {
  case 0:
    c.kind = "jittered wall";
    addWall(c, random, 1 + random.below(2));
    moveNodes(c, random, 0.01, 0.005);
    c.node_tolerance = c.face_tolerance = 0.025;
    break;
  case 1:
    c.kind = "touching wall"; // coordinates are dyadic: boxes touch exactly
    addWall(c, random, 1 + random.below(2));
    c.node_tolerance = random.chance(0.5) ? 0 : 0.25;
    break;
  case 2: {
    c.kind = "coincident";
    const double x[4] = {0, 1, 1, 0}, y[4] = {0, 0, 1, 1};
    addQuads(c, 2 + random.below(120), 6, random, [&](int, int k) {
      return Point{x[k], y[k], 0.5};
    });
    c.face_tolerance = 0.125;
    break;
  }
  case 3:
    c.kind = "degenerate";
    addQuads(c, 2 + random.below(60), 5, random, [&](int q, int k) {
      const double at = 0.5 * random.below(4);
      if (q % 3 == 0) // a point
        return Point{0.5 * (q % 4), 0.5 * (q / 4 % 4), 0};
      if (q % 3 == 1) // a line
        return Point{at, 0.5 * (q % 4), 0};
      return Point{at, 0.5 * random.below(4), k == 0 ? 0.5 : 0};
    });
    if (random.chance(0.5))
      c.node_tolerance = 0.25;
    break;
  case 4:
    c.kind = "single face";
    addQuads(c, 1 + random.below(2), 2, random, [&](int, int) {
      return Point{random.real(0, 1), random.real(0, 1), random.real(0, 1)};
    });
    c.node_tolerance = c.face_tolerance = 0.1;
    break;
  case 5:
    c.kind = "far apart";
    for (int body = 0; body < 2 + random.below(6); ++body) {
      const double x = 1e6 * body * body;
      addBrick(c, body, {x, -x, 0}, {x + 1, 1 - x, 1}, {2, 1, 1});
    }
    moveNodes(c, random, 0.01, 0.01);
    c.node_tolerance = c.face_tolerance = 0.05;
    break;
  case 6:
    c.kind = "swept";
    addWall(c, random, 1);
    moveNodes(c, random, 0.1, 0.1);
    for (auto& node : c.nodes)
      if (node.body % 3 == 0) {
        node.x_new[0] += 5;
        node.x_new[1] -= 3;
      }
    c.node_tolerance = c.face_tolerance = 0.01;
    break;
  case 7:
    c.kind = "soup";
    addQuads(c, 5 + random.below(150), 20, random, [&](int q, int) {
      const double size = q % 10 == 0 ? 3 : 0.3;
      Random at(static_cast<std::uint64_t>(q));
      return Point{at.real(0, 4) + random.real(-size, size),
                   at.real(0, 4) + random.real(-size, size),
                   at.real(0, 4) + random.real(-size, size)};
    });
    moveNodes(c, random, 0, 0.2);
    c.node_tolerance = random.real(0, 0.2);
    c.face_tolerance = random.real(0, 0.2);
    break;
  case 8:
    c.kind = "outlier";
    addWall(c, random, 1);
    addBrick(c, 1000, {1e12, 1e12, 1e12}, {1e12 + 4, 1e12 + 1, 1e12 + 1}, {2, 1, 1});
    addBrick(c, 1001, {-1e300, 0, 0}, {1e300, 1, 1}, {1, 1, 1});
    c.node_tolerance = c.face_tolerance = 0.05;
    break;
  default:
    c.kind = "nothing";
    break;
  }
}

// Distribution of faces over ranks: slabs in x, blocks of bodies, at random, or all on a few ranks.
inline void distribute(SurfaceCase& c, Random& random, int num_ranks) {
  const int pattern = random.below(4);
  const int used = pattern == 3 ? 1 + random.below(num_ranks) : num_ranks;
  const int first = random.below(num_ranks);
  double lower = 1e300, upper = -1e300;
  for (const auto& node : c.nodes) {
    lower = std::min(lower, node.x_old[0]);
    upper = std::max(upper, node.x_old[0]);
  }
  for (auto& face : c.faces) {
    int part = random.below(used);
    if (pattern == 0 && upper > lower)
      part = static_cast<int>((c.nodes[face.corners[0]].x_old[0] - lower) / (upper - lower) * used);
    else if (pattern == 1)
      part = static_cast<int>(face.body);
    face.rank = (first + std::max(0, part) % used) % num_ranks;
    for (const int corner : face.corners)
      c.nodes[corner].sharers.push_back(face.rank);
  }
  for (auto& node : c.nodes) {
    if (random.chance(0.05)) // a rank may have a surface node without any of its faces
      node.sharers.push_back(random.below(num_ranks));
    std::sort(node.sharers.begin(), node.sharers.end());
    node.sharers.erase(std::unique(node.sharers.begin(), node.sharers.end()), node.sharers.end());
    node.owner = node.sharers.empty() ? -1 : node.sharers.front();
  }
  c.shuffled = random.chance(0.5);
}

inline SurfaceCase makeCase(std::uint64_t seed, int num_ranks) {
  SurfaceCase c;
  Random random(seed);
  c.seed = seed;
  buildKind(c, random, static_cast<int>(seed % 10));
  c.drop_same_body = random.chance(0.4);
  distribute(c, random, num_ranks);
  return c;
}

template <class ViewType, class Value>
ViewType viewOf(std::size_t n, std::size_t width, const Value& value) {
  using View = typename ViewType::non_const_type;
  View view;
  if constexpr (ViewType::rank == 1)
    view = View("test", n);
  else if constexpr (ViewType::rank_dynamic == 2)
    view = View("test", n, width);
  else
    view = View("test", n);
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < width; ++j)
      if constexpr (ViewType::rank == 1)
        host(i) = value(i, j);
      else
        host(i, j) = value(i, j);
  Kokkos::deep_copy(view, host);
  return view;
}

constexpr int num_test_attributes = 3;
struct TestAttributes {
  double value[num_test_attributes];
};
inline TestAttributes testAttributes(global_id face) {
  const double of_face = 1.5 * static_cast<double>(face);
  return {{of_face, of_face + 0.1, of_face + 0.2}};
}

// One rank's part of the case.
struct LocalSurface {
  Surface surface;
  std::vector<int> nodes; // [local] index into the case's
  std::vector<int> faces;
};

inline LocalSurface localSurface(const SurfaceCase& c, int rank) {
  LocalSurface local;
  std::vector<int> local_of(c.nodes.size(), -1);
  for (std::size_t n = 0; n < c.nodes.size(); ++n)
    if (std::count(c.nodes[n].sharers.begin(), c.nodes[n].sharers.end(), rank))
      local.nodes.push_back(static_cast<int>(n));
  for (std::size_t f = 0; f < c.faces.size(); ++f)
    if (c.faces[f].rank == rank)
      local.faces.push_back(static_cast<int>(f));
  if (c.shuffled) {
    Random random(c.seed + 77);
    random.shuffle(local.nodes);
    random.shuffle(local.faces);
  }
  for (std::size_t i = 0; i < local.nodes.size(); ++i)
    local_of[local.nodes[i]] = static_cast<int>(i);
  const std::size_t nn = local.nodes.size(), nf = local.faces.size();
  const auto node = [&](std::size_t i) -> const CaseNode& { return c.nodes[local.nodes[i]]; };
  const auto face = [&](std::size_t i) -> const CaseFace& { return c.faces[local.faces[i]]; };
  Surface& s = local.surface;
  using Ids = View<const global_id*>;
  s.num_nodes = static_cast<int>(nn);
  s.num_faces = static_cast<int>(nf);
  s.coordinates_old =
      viewOf<View<const double* [3]>>(nn, 3, [&](auto i, auto d) { return node(i).x_old[d]; });
  s.coordinates_new =
      viewOf<View<const double* [3]>>(nn, 3, [&](auto i, auto d) { return node(i).x_new[d]; });
  s.face_to_nodes = viewOf<View<const int* [4]>>(
      nf, 4, [&](auto i, auto k) { return local_of[face(i).corners[k]]; });
  s.node_ids = viewOf<Ids>(nn, 1, [&](auto i, auto) { return node(i).id; });
  s.face_ids = viewOf<Ids>(nf, 1, [&](auto i, auto) { return face(i).id; });
  s.node_is_owned = viewOf<View<const unsigned char*>>(
      nn, 1, [&](auto i, auto) { return static_cast<unsigned char>(node(i).owner == rank); });
  s.node_body = viewOf<Ids>(nn, 1, [&](auto i, auto) { return node(i).body; });
  s.face_body = viewOf<Ids>(nf, 1, [&](auto i, auto) { return face(i).body; });
  s.face_attributes = viewOf<ConstAttributeWords>(nf, num_test_attributes, [&](auto i, auto a) {
    AttributeWord word;
    const TestAttributes attributes = testAttributes(face(i).id);
    memcpy(&word, &attributes.value[a], sizeof word);
    return word;
  });
  return local;
}

} // namespace brickwall::contact::test
