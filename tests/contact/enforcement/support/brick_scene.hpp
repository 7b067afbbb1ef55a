// Bricks of hexahedra for contact tests. Every rank holds the whole scene on the host, so that
// ghosts, pairs and sums can be made by brute force and compared with the answer of one rank. The
// program works differently.
#pragma once

#include "contact/base/to_device.hpp"
#include "contact/enforcement/enforcement.hpp"
#include "contact/surface/candidate_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace brickwall::contact::testing {

// A static scene on the host: nodes, elements and skin of all bricks, in global numbering.
struct Scene {
  struct Face {
    std::array<int, 4> nodes;
    global_id id, body; // body, or side of a body
    int element;
    double surface_mass;
  };
  std::vector<Vec3> x_old, x_new; // [node]
  std::vector<double> mass; // [node]
  std::vector<int> node_body; // [node]
  std::vector<std::array<int, 8>> elements;
  std::vector<Face> faces;
  int num_bodies = 0;

  // Adds a brick of `n` elements; `place` maps its box [0, size] to space. Returns its body number.
  template <class Place>
  int addBrick(const Vec3& size, const std::array<int, 3>& n, double density, const Place& place) {
    const int body = num_bodies++, first = static_cast<int>(x_new.size());
    const Vec3 h = {size.x / n[0], size.y / n[1], size.z / n[2]};
    const auto node = [&](int i, int j, int k) {
      return first + i + (n[0] + 1) * (j + (n[1] + 1) * k);
    };
    for (int k = 0; k <= n[2]; ++k)
      for (int j = 0; j <= n[1]; ++j)
        for (int i = 0; i <= n[0]; ++i) {
          x_new.push_back(place(Vec3{i * h.x, j * h.y, k * h.z}));
          mass.push_back(0);
          node_body.push_back(body);
        }
    x_old.insert(x_old.end(), x_new.begin() + first, x_new.end());
    static constexpr int sides[6][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6},
                                        {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}};
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          const int elem = static_cast<int>(elements.size());
          elements.push_back({node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k),
                              node(i, j + 1, k), node(i, j, k + 1), node(i + 1, j, k + 1),
                              node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)});
          for (const int corner : elements.back())
            mass[corner] += density * h.x * h.y * h.z / 8;
          const bool outside[6] = {j == 0, i == n[0] - 1, j == n[1] - 1,
                                   i == 0, k == 0,        k == n[2] - 1};
          const double thickness[6] = {h.y, h.x, h.y, h.x, h.z, h.z};
          for (int side = 0; side < 6; ++side)
            if (outside[side]) {
              Face face;
              for (int c = 0; c < 4; ++c)
                face.nodes[c] = elements.back()[sides[side][c]];
              face.id = global_id(elem) * 6 + side;
              face.body = body;
              face.element = elem;
              face.surface_mass = 0.5 * density * thickness[side];
              faces.push_back(face);
            }
        }
    return body;
  }
  int addBox(const Vec3& corner, const Vec3& size, const std::array<int, 3>& n,
             double density = 1) {
    return addBrick(size, n, density, [&](const Vec3& p) { return corner + p; });
  }
  // Sets x^n = x^{n+1} - motion for the nodes of a body.
  void cameBy(int body, const Vec3& motion) {
    for (std::size_t i = 0; i < x_new.size(); ++i)
      if (node_body[i] == body)
        x_old[i] = x_new[i] - motion;
  }
  // x^{n+1} becomes x^n.
  void step() { x_old = x_new; }
  void move(int body, const Vec3& motion) {
    for (std::size_t i = 0; i < x_new.size(); ++i)
      if (node_body[i] == body)
        x_new[i] += motion;
  }
  void fix(int body) {
    for (std::size_t i = 0; i < x_new.size(); ++i)
      if (node_body[i] == body)
        mass[i] = HUGE_VAL;
  }
  int nodeAt(int body, const Vec3& p) const {
    for (std::size_t i = 0; i < x_new.size(); ++i)
      if (node_body[i] == body && norm(x_new[i] - p) < 1e-6)
        return static_cast<int>(i);
    return -1;
  }
};

// One rank's part of a scene with its contact enforcement. `cut` gives the rank of an element.
class ScenePart {
public:
  template <class Cut>
  ScenePart(const Scene& scene, MPI_Comm comm, const Cut& cut, double reach)
      : _comm(comm), _rank(rankOf(comm)), _reach(reach) {
    std::vector<int> owner(scene.x_new.size(), sizeOf(comm));
    for (std::size_t e = 0; e < scene.elements.size(); ++e)
      for (const int node : scene.elements[e])
        owner[node] = std::min(owner[node], cut(static_cast<int>(e)));
    std::set<int> nodes;
    std::vector<std::pair<int, int>> others;
    for (std::size_t f = 0; f < scene.faces.size(); ++f) {
      const int rank = cut(scene.faces[f].element);
      if (rank == _rank)
        _faces.push_back(static_cast<int>(f));
      else
        others.emplace_back(rank, static_cast<int>(f));
      for (const int node : scene.faces[f].nodes)
        if (rank == _rank || owner[node] == _rank)
          nodes.insert(node);
    }
    std::sort(others.begin(), others.end());
    for (const auto& other : others)
      _ghosts.push_back(other.second);
    _nodes.assign(nodes.begin(), nodes.end());
    makeSurface(scene, owner);
    update(scene);
  }

  // Takes over the scene's coordinates and rebuilds ghosts and pairs.
  void update(const Scene& scene) {
    setCoordinates(scene);
    findPairs(scene);
  }

  const Surface& surface() const { return _surface; }
  const GhostFaces& ghosts() const { return _ghost_faces; }
  const CandidatePairs& pairs() const { return _pairs; }
  const View<const double*> nodeMass() const { return _mass; }
  const std::vector<int>& nodes() const { return _nodes; } // global number of each surface node
  MPI_Comm comm() const { return _comm; }

  // Collective. Totals over all ranks [global node][xyz] of partial sums.
  std::vector<std::array<std::int64_t, 3>> total(const ContactForces& forces, std::size_t num_nodes,
                                                 const Scene& scene) const {
    std::vector<std::array<std::int64_t, 3>> sum(num_nodes, {0, 0, 0});
    const auto own = toHost(forces.nodes);
    const auto ghost = toHost(forces.ghost_corners);
    for (std::size_t i = 0; i < _nodes.size(); ++i)
      for (int d = 0; d < 3; ++d)
        sum[_nodes[i]][d] += own(i, d);
    for (std::size_t g = 0; g < _ghosts.size(); ++g)
      for (int j = 0; j < 4; ++j)
        for (int d = 0; d < 3; ++d)
          sum[scene.faces[_ghosts[g]].nodes[j]][d] += ghost(g, 3 * j + d);
    allReduce(_comm, sum[0].data(), static_cast<int>(3 * num_nodes), MPI_SUM);
    return sum;
  }

  // The same of the forces of an enforcement. Copies of a total have the same bits.
  std::vector<std::array<std::int64_t, 3>> total(const Enforcement& enforcement,
                                                 std::size_t num_nodes, const Scene& scene) const {
    if (!enforcement.hasTotals())
      return total(enforcement.forces(), num_nodes, scene);
    std::vector<std::array<std::int64_t, 3>> largest(num_nodes, {INT64_MIN, INT64_MIN, INT64_MIN});
    std::vector<std::array<std::int64_t, 3>> least(num_nodes, {INT64_MAX, INT64_MAX, INT64_MAX});
    const auto own = toHost(enforcement.forces().nodes);
    for (std::size_t i = 0; i < _nodes.size(); ++i)
      for (int d = 0; d < 3; ++d)
        largest[_nodes[i]][d] = least[_nodes[i]][d] = own(i, d);
    allReduce(_comm, largest[0].data(), static_cast<int>(3 * num_nodes), MPI_MAX);
    allReduce(_comm, least[0].data(), static_cast<int>(3 * num_nodes), MPI_MIN);
    for (std::size_t n = 0; n < num_nodes; ++n)
      if (largest[n][0] == INT64_MIN) // not on the surface of any rank
        largest[n] = least[n] = {0, 0, 0};
    EXPECT_EQ(largest, least) << "copies of a node differ";
    return largest;
  }

  // The host's input of the energy-neutral scheme, by brute force. `acceleration` [global node].
  NeutralInput neutralInput(const Scene& scene, const std::vector<Vec3>& acceleration) const {
    NeutralInput input;
    input.accelerations = [values = atNodes(acceleration)](const NodeList&) { return values; };
    input.sum_forces = [this, &scene](const ContactForces& forces) {
      const auto sum = total(forces, scene.x_new.size(), scene);
      const auto nodes = Kokkos::create_mirror_view(forces.nodes);
      for (std::size_t i = 0; i < _nodes.size(); ++i)
        for (int d = 0; d < 3; ++d)
          nodes(i, d) = sum[_nodes[i]][d];
      Kokkos::deep_copy(forces.nodes, nodes);
    };
    input.share_with_ghosts = [this, &scene](const View<const double* [3]>& from,
                                             const View<double* [12]>& to) {
      const auto host_from = toHost(from);
      std::vector<double> all(3 * scene.x_new.size(), -HUGE_VAL); // every copy has the same bits
      for (std::size_t i = 0; i < _nodes.size(); ++i)
        for (int d = 0; d < 3; ++d)
          all[3 * _nodes[i] + d] = host_from(i, d);
      allReduce(_comm, all.data(), static_cast<int>(all.size()), MPI_MAX);
      const auto host_to = Kokkos::create_mirror_view(to);
      for (std::size_t g = 0; g < _ghosts.size(); ++g)
        for (int j = 0; j < 4; ++j)
          for (int d = 0; d < 3; ++d)
            host_to(g, 3 * j + d) = all[3 * scene.faces[_ghosts[g]].nodes[j] + d];
      Kokkos::deep_copy(to, host_to);
    };
    return input;
  }

private:
  void makeSurface(const Scene& scene, const std::vector<int>& owner) {
    const int num_nodes = static_cast<int>(_nodes.size()),
              num_faces = static_cast<int>(_faces.size());
    _surface.num_nodes = num_nodes;
    _surface.num_faces = num_faces;
    _surface.node_ids =
        filled<View<global_id*>>(num_nodes, [&](auto& v, int i) { v(i) = _nodes[i]; });
    _surface.node_is_owned = filled<View<unsigned char*>>(
        num_nodes, [&](auto& v, int i) { v(i) = owner[_nodes[i]] == _rank; });
    _surface.node_body = filled<View<global_id*>>(
        num_nodes, [&](auto& v, int i) { v(i) = scene.node_body[_nodes[i]]; });
    _mass = filled<View<double*>>(num_nodes, [&](auto& v, int i) { v(i) = scene.mass[_nodes[i]]; });
    _surface.face_to_nodes = filled<View<int* [4]>>(num_faces, [&](auto& v, int f) {
      for (int j = 0; j < 4; ++j)
        v(f, j) = static_cast<int>(
            std::lower_bound(_nodes.begin(), _nodes.end(), scene.faces[_faces[f]].nodes[j]) -
            _nodes.begin());
    });
    setFaces(scene, _faces, _surface.face_ids, _surface.face_body, _surface.face_attributes);
    for (const int node : _nodes)
      _is_owned.push_back(owner[node] == _rank);

    const int num_ghosts = static_cast<int>(_ghosts.size());
    _ghost_faces.count = num_ghosts;
    _ghost_faces.corner_ids = View<global_id* [4]>("test::ghost_corner_ids", num_ghosts);
    setFaces(scene, _ghosts, _ghost_faces.face_ids, _ghost_faces.bodies, _ghost_faces.attributes);
  }
  // Ids, bodies and attributes of these faces.
  template <class Ids, class Words>
  static void setFaces(const Scene& scene, const std::vector<int>& faces, Ids& ids, Ids& bodies,
                       Words& attributes) {
    const int n = static_cast<int>(faces.size());
    ids = filled<View<global_id*>>(n, [&](auto& v, int f) { v(f) = scene.faces[faces[f]].id; });
    bodies =
        filled<View<global_id*>>(n, [&](auto& v, int f) { v(f) = scene.faces[faces[f]].body; });
    const auto setRow = [&](auto& v, int f) {
      const Scene::Face& face = scene.faces[faces[f]];
      FaceAttributes values;
      for (int j = 0; j < 4; ++j)
        values.corner_mass[j] = scene.mass[face.nodes[j]];
      values.surface_mass = face.surface_mass;
      attributesAt<FaceAttributes>(v, f) = values;
    };
    attributes = filled<AttributeWords>(n, setRow, words_of<FaceAttributes>);
  }
  template <class ViewType, class Set, class... Extents>
  static ViewType filled(int num_rows, const Set& set, Extents... more) {
    const ViewType view("test::filled", num_rows, more...);
    const auto host = Kokkos::create_mirror_view(view);
    for (int row = 0; row < num_rows; ++row)
      set(host, row);
    Kokkos::deep_copy(view, host);
    return view;
  }

  using Vectors = View<double* [3]>; // [node][xyz]

  // The rows of this rank's surface nodes in `all` [global node].
  Vectors atNodes(const std::vector<Vec3>& all) const {
    return filled<Vectors>(static_cast<int>(_nodes.size()), [&](auto& v, int i) {
      for (int d = 0; d < 3; ++d)
        v(i, d) = all[_nodes[i]][d];
    });
  }

  void setCoordinates(const Scene& scene) {
    const auto of_ghosts = [&](const std::vector<Vec3>& x) {
      return filled<View<double* [12]>>(_ghost_faces.count, [&](auto& v, int g) {
        for (int j = 0; j < 4; ++j)
          for (int d = 0; d < 3; ++d)
            v(g, 3 * j + d) = x[scene.faces[_ghosts[g]].nodes[j]][d];
      });
    };
    _surface.coordinates_old = atNodes(scene.x_old);
    _surface.coordinates_new = atNodes(scene.x_new);
    _ghost_faces.coordinates_old = of_ghosts(scene.x_old);
    _ghost_faces.coordinates_new = of_ghosts(scene.x_new);
  }

  static bool near(const Vec3& p, const Scene& scene, const Scene::Face& face, double reach) {
    for (int d = 0; d < 3; ++d) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const int node : face.nodes) {
        low = std::min({low, scene.x_new[node][d], scene.x_old[node][d]});
        high = std::max({high, scene.x_new[node][d], scene.x_old[node][d]});
      }
      if (p[d] < low - reach || p[d] > high + reach)
        return false;
    }
    return true;
  }
  void findPairs(const Scene& scene) {
    std::vector<std::int64_t> offsets(1, 0);
    std::vector<int> listed;
    std::vector<int> order(_faces.size() + _ghosts.size());
    for (std::size_t f = 0; f < order.size(); ++f)
      order[f] = static_cast<int>(f);
    const auto faceOf = [&](int f) -> const Scene::Face& {
      const int num_own = static_cast<int>(_faces.size());
      return scene.faces[f < num_own ? _faces[f] : _ghosts[f - num_own]];
    };
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return std::make_pair(faceOf(a).body, faceOf(a).id) <
             std::make_pair(faceOf(b).body, faceOf(b).id);
    });
    for (std::size_t i = 0; i < _nodes.size(); ++i) {
      for (const int f : order)
        if (_is_owned[i] && bodyOfSide(faceOf(f).body) != scene.node_body[_nodes[i]] &&
            (near(scene.x_new[_nodes[i]], scene, faceOf(f), _reach) ||
             near(scene.x_old[_nodes[i]], scene, faceOf(f), _reach)))
          listed.push_back(f);
      offsets.push_back(static_cast<std::int64_t>(listed.size()));
    }
    const auto row_offsets = filled<View<std::int64_t*>>(
        static_cast<int>(offsets.size()), [&](auto& v, int i) { v(i) = offsets[i]; });
    _pairs.faces = filled<View<int*>>(static_cast<int>(listed.size()),
                                      [&](auto& v, int i) { v(i) = listed[i]; });
    layOutRowsByNode(exec_space(), static_cast<int>(_nodes.size()), row_offsets, _pairs);
  }

  MPI_Comm _comm;
  int _rank;
  double _reach;
  std::vector<int> _nodes, _faces, _ghosts; // global numbers
  std::vector<char> _is_owned;
  Surface _surface;
  GhostFaces _ghost_faces;
  CandidatePairs _pairs;
  View<const double*> _mass;
};

} // namespace brickwall::contact::testing
