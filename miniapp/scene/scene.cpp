#include "miniapp/scene/scene.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/base/vec3.hpp"
#include "io/exodus/id_maps.hpp"
#include "io/exodus/mesh_reader.hpp"
#include "io/wall/wall_generator.hpp"
#include "mechanics/mesh/body_inertia.hpp"
#include "mechanics/mesh/lumped_mass.hpp"
#include "miniapp/scene/conflicting_sets.hpp"
#include "miniapp/scene/entity_names.hpp"
#include "miniapp/scene/force_range.hpp"
#include "miniapp/scene/load_warnings.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>

namespace brickwall::miniapp {

namespace {

std::vector<mechanics::Material> materialsOf(const Config& config,
                                             const std::vector<io::Block>& blocks) {
  std::vector<mechanics::Material> materials;
  materials.reserve(blocks.size());
  for (const auto& block : blocks)
    materials.push_back(*config.materialOf(block.name));
  return materials;
}

// Runs of consecutive elements of one body.
std::vector<mechanics::ElementRange> bodyRanges(const std::vector<global_id>& elem_body) {
  std::vector<mechanics::ElementRange> ranges;
  for (int elem = 0; elem < static_cast<int>(elem_body.size()); ++elem) {
    if (ranges.empty() || ranges.back().body != elem_body[elem])
      ranges.push_back({elem, 0, elem_body[elem]});
    ++ranges.back().count;
  }
  return ranges;
}

mechanics::HexMesh toHexMesh(const exec_space& space, const io::MeshPart& part,
                             const std::vector<unsigned char>& node_is_owned,
                             const std::vector<mechanics::Material>& materials) {
  mechanics::HexMesh mesh;
  mesh.num_nodes = part.numNodes();
  mesh.num_elems = part.numElems();
  mesh.elem_to_nodes =
      toDevice<View<int* [8]>>(space, "miniapp::mesh::elem_to_nodes", part.elem_nodes);
  mesh.elem_ids = toDevice<View<global_id*>>(space, "miniapp::mesh::elem_ids", part.elem_ids);
  mesh.node_ids = toDevice<View<global_id*>>(space, "miniapp::mesh::node_ids", part.node_ids);
  mesh.node_is_owned =
      toDevice<View<unsigned char*>>(space, "miniapp::mesh::node_is_owned", node_is_owned);
  mesh.elem_block = toDevice<View<int*>>(space, "miniapp::mesh::elem_block", part.elem_block);
  mesh.materials =
      toDevice<View<mechanics::Material*>>(space, "miniapp::mesh::materials", materials);
  mesh.reference_coordinates =
      toDevice<View<double* [3]>>(space, "miniapp::mesh::reference_coordinates", part.coordinates);
  mesh.bodies = bodyRanges(part.elem_body);
  return mesh;
}

void refuseEdgesOfZeroLength(const exec_space& space, MPI_Comm comm, const Scene& scene) {
  const auto face_to_nodes = scene.skin.face_to_nodes;
  const auto ids = scene.skin.face_ids;
  const auto X = scene.mesh.reference_coordinates;
  global_id first = INT64_MAX;
  Kokkos::parallel_reduce(
      "miniapp::refuseEdgesOfZeroLength", rangePolicy(space, scene.skin.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face, global_id& least) {
        for (int corner = 0; corner < 4; ++corner)
          if (!(norm(rowOf(X, face_to_nodes(face, (corner + 1) % 4)) -
                     rowOf(X, face_to_nodes(face, corner))) > 0))
            least = minOf(least, ids(face));
      },
      Kokkos::Min<global_id>(first));
  first = allReduce(comm, first, MPI_MIN);
  if (first != INT64_MAX)
    throw InputError("the mesh has an edge of length zero on " +
                     EntityNames(comm, scene.part).face(first) +
                     "; expected hexahedra with eight distinct corners");
}

void measureSkinEdges(const exec_space& space, MPI_Comm comm, Scene& scene) {
  const auto face_to_nodes = scene.skin.face_to_nodes;
  const auto X = scene.mesh.reference_coordinates;
  double shortest = HUGE_VAL, longest = 0;
  Kokkos::parallel_reduce(
      "miniapp::measureSkinEdges", rangePolicy(space, scene.skin.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face, double& least, double& most) {
        for (int corner = 0; corner < 4; ++corner) {
          const Vec3 a = rowOf(X, face_to_nodes(face, corner));
          const Vec3 b = rowOf(X, face_to_nodes(face, (corner + 1) % 4));
          least = minOf(least, norm(b - a));
          most = maxOf(most, norm(b - a));
        }
      },
      Kokkos::Min<double>(shortest), Kokkos::Max<double>(longest));
  scene.shortest_edge = allReduce(comm, shortest, MPI_MIN);
  scene.longest_edge = allReduce(comm, longest, MPI_MAX);
  if (!(scene.shortest_edge > 0))
    refuseEdgesOfZeroLength(space, comm, scene);
}

// Far from the origin coordinates are coarse: the spacing of doubles there, over the shortest edge.
// Above this share, volumes and gaps err by as much.
constexpr double coarse_positions = 1e-6;

// A warning, or nothing. Collective.
std::vector<std::string> coarsePositions(const exec_space& space, MPI_Comm comm,
                                         const Scene& scene) {
  const auto X = scene.mesh.reference_coordinates;
  double farthest = 0;
  Kokkos::parallel_reduce(
      "miniapp::coarsePositions", rangePolicy(space, scene.mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, double& most) {
        for (int d = 0; d < 3; ++d)
          most = maxOf(most, X(node, d) < 0 ? -X(node, d) : X(node, d));
      },
      Kokkos::Max<double>(farthest));
  farthest = allReduce(comm, farthest, MPI_MAX);
  const double spacing = farthest * std::numeric_limits<double>::epsilon();
  if (!(spacing > coarse_positions * scene.shortest_edge))
    return {};
  std::ostringstream text;
  text.precision(2);
  text << "coordinates of up to " << farthest << " are rounded to about " << spacing << ", "
       << spacing / scene.shortest_edge
       << " of the shortest edge, and so are volumes and gaps: move the mesh to the origin";
  return {text.str()};
}

template <class Set>
const Set& findByName(const std::vector<Set>& sets, const std::string& name,
                      const std::string& kind) {
  std::vector<std::string> names;
  std::string known;
  for (const auto& set : sets) {
    if (set.name == name)
      return set;
    names.push_back(set.name);
    known += (known.empty() ? "" : ", ") + set.name;
  }
  const std::string nearest = io::nearestName(name, names);
  throw InputError("found no " + kind + " '" + name + "' in the mesh, expected " +
                   (known.empty() ? "none, as it has no " + kind : "one of " + known) +
                   (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

// A deck names one set; if several sets have that name, the choice would be ambiguous.
template <class Set>
void refuseSharedName(const Config& config, const std::vector<Set>& sets, const Set& found,
                      const std::string& kind) {
  std::string ids;
  int count = 0;
  for (const auto& set : sets)
    if (set.name == found.name) {
      ids += (count == 0 ? "" : ", ") + std::to_string(set.id);
      ++count;
    }
  if (count > 1)
    throw InputError(config.mesh->file + " has " + std::to_string(count) + " " + kind + "s '" +
                     found.name + "' (ids " + ids + "); expected a name of one " + kind);
}

// A key of a table as a deck must write it.
std::string tomlKey(const std::string& name) {
  const bool is_bare = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return (c < 128 && std::isalnum(c) != 0) || c == '_' || c == '-';
  });
  if (is_bare)
    return name;
  std::string quoted = "\"";
  for (const char c : name)
    quoted += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
  return quoted + "\"";
}

std::string hasNoEffect(const std::string& where, const std::string& kind,
                        const std::string& name) {
  return where + " has no effect: " + kind + " \"" + name + "\" has no element or node of the mesh";
}

// Reports all names in the deck that the mesh lacks or has twice in one error. Returns warnings of
// materials and initial states of empty blocks.
std::vector<std::string> checkNames(const Config& config, const io::MeshPart& part) {
  std::string faults;
  std::vector<std::string> warnings;
  const auto look = [&](const std::string& where, const auto& find) {
    try {
      find();
    } catch (const InputError& error) {
      faults += (faults.empty() ? "" : "\n") + where + ": " + error.what();
    }
  };
  for (const auto& block : part.blocks)
    look(config.deck_path + ": [material]", [&] {
      if (!config.materialOf(block.name))
        throw InputError("element block '" + block.name + "' has no material; expected a table " +
                         "[material." + tomlKey(block.name) + "]");
    });
  const auto look_for_block = [&](const std::string& place, const std::string& table,
                                  const std::string& name) {
    const std::vector<std::string>& empty = part.empty_blocks;
    if (std::find(empty.begin(), empty.end(), name) != empty.end())
      warnings.push_back(hasNoEffect(table, "element block", name));
    else
      look(place + ": " + table, [&] { findByName(part.blocks, name, "element block"); });
  };
  if (config.mesh) // those of walls are known without a mesh
    for (const auto& material : config.materials)
      look_for_block(material.place, "[material." + tomlKey(material.block) + "]", material.block);
  for (const auto& load : config.pressures)
    look(load.place + ": [[load.pressure]]", [&] {
      refuseSharedName(config, part.side_sets, sideSetOf(part, load.side_set), "side set");
    });
  const auto look_for_nodes = [&](const std::string& where, const std::string& name) {
    look(where,
         [&] { refuseSharedName(config, part.node_sets, nodeSetOf(part, name), "node set"); });
  };
  for (const auto& fixed : config.fixed)
    look_for_nodes(fixed.place + ": [[boundary.fixed]]", fixed.node_set);
  for (const auto& moving : config.prescribed)
    look_for_nodes(moving.place + ": [[boundary.velocity]]", moving.node_set);
  for (const auto& initial : config.initial_velocities)
    if (initial.block)
      look_for_block(initial.place, "[[initial.velocity]]", *initial.block);
  for (const auto& initial : config.initial_deformations)
    if (initial.block)
      look_for_block(initial.place, "[[initial.deformation]]", *initial.block);
  if (!faults.empty())
    throw InputError(faults);
  return warnings;
}

// Conditions on empty sets have no effect.
std::vector<std::string> emptySets(MPI_Comm comm, const Config& config, const io::MeshPart& part) {
  std::vector<std::string> warnings;
  const auto warnIfEmpty = [&](const char* where, const char* kind, const std::string& name,
                               std::size_t members) {
    if (allReduce(comm, static_cast<std::int64_t>(members), MPI_SUM) == 0)
      warnings.push_back(hasNoEffect(std::string("[[") + where + "]]", kind, name));
  };
  for (const auto& load : config.pressures)
    warnIfEmpty("load.pressure", "side set", load.side_set,
                sideSetOf(part, load.side_set).elems.size());
  for (const auto& fixed : config.fixed)
    warnIfEmpty("boundary.fixed", "node set", fixed.node_set,
                nodeSetOf(part, fixed.node_set).nodes.size());
  for (const auto& moving : config.prescribed)
    warnIfEmpty("boundary.velocity", "node set", moving.node_set,
                nodeSetOf(part, moving.node_set).nodes.size());
  return warnings;
}

// Sets mass and skin of a scene; errors name the file, and elements by their ids there. Collective.
void findMassAndSkin(const exec_space& space, MPI_Comm comm, const Config& config,
                     const mechanics::SharedNodeLists& shared, Scene& scene) {
  const std::string file = config.mesh ? config.mesh->file + ": " : "";
  try {
    scene.mass = mechanics::lumpedMass(space, comm, scene.mesh, scene.shared);
    scene.skin = mechanics::findSkin(space, comm, scene.mesh, shared);
    measureSkinEdges(space, comm, scene);
  } catch (const mechanics::BadElementError& error) { // on all ranks
    throw InputError(file + EntityNames(comm, scene.part).element(error.elem) + " " + error.fault);
  } catch (const InputError& error) { // on all ranks
    throw InputError(file + error.what());
  }
}

} // namespace

void refuseUnknownBodies(const Config& config, global_id num_bodies) {
  const auto refuse = [&](const char* block, const InitialSelection& entry) {
    if (entry.body && *entry.body >= num_bodies)
      throw InputError(entry.place + ": [[" + block + "]] body: found the integer " +
                       std::to_string(*entry.body) + ", expected at most " +
                       std::to_string(num_bodies - 1) + ", the number of the last body");
  };
  for (const auto& entry : config.initial_velocities)
    refuse("initial.velocity", entry);
  for (const auto& entry : config.initial_deformations)
    refuse("initial.deformation", entry);
}

io::MeshPart makeMeshPart(MPI_Comm comm, const Config& config) {
  return config.wall ? io::generateWall(comm, *config.wall) : io::readMesh(comm, config.mesh->file);
}

mechanics::SharedNodeLists sharedNodes(const io::MeshPart& part) {
  mechanics::SharedNodeLists shared;
  for (const auto& list : part.shared_nodes) {
    shared.ranks.push_back(list.rank);
    shared.nodes.push_back(list.nodes);
  }
  return shared;
}

Scene makeScene(const exec_space& space, MPI_Comm comm, const Config& config) {
  return makeScene(space, comm, config, makeMeshPart(comm, config));
}

Scene makeScene(const exec_space& space, MPI_Comm comm, const Config& config, io::MeshPart part) {
  Scene scene;
  scene.part = std::move(part);
  scene.warnings = checkNames(config, scene.part);
  refuseUnknownBodies(config, scene.part.num_global_bodies);
  refuseConflictingSets(comm, config, scene.part);
  for (const std::string& warning : emptySets(comm, config, scene.part))
    scene.warnings.push_back(warning);
  const auto materials = materialsOf(config, scene.part.blocks);
  scene.node_is_owned = hostArray<unsigned char>(scene.part.numNodes());
  std::transform(scene.part.node_owner.begin(), scene.part.node_owner.end(),
                 scene.node_is_owned.begin(),
                 [rank = rankOf(comm)](int owner) { return owner == rank; });
  scene.mesh = toHexMesh(space, scene.part, scene.node_is_owned, materials);

  const mechanics::SharedNodeLists shared = sharedNodes(scene.part);
  scene.shared = mechanics::SharedNodeSum(space, comm, shared);
  findMassAndSkin(space, comm, config, shared, scene);
  for (const std::string& warning : checkForceRange(comm, scene.part, materials))
    scene.warnings.push_back(warning);
  if (config.mass == NodalMass::inertia) {
    const auto body_mass = mechanics::massWithInertia(space, comm, scene.mesh, scene.mass);
    scene.mass = body_mass.mass;
    scene.mass_shares = body_mass.least_shares;
  }
  for (const auto& warnings : {coarsePositions(space, comm, scene),
                               interiorSideWarnings(comm, config, scene.part, scene.skin)})
    scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
  scene.num_faces = allReduce(comm, std::int64_t(scene.skin.num_faces), MPI_SUM);
  return scene;
}

const io::SideSet& sideSetOf(const io::MeshPart& part, const std::string& name) {
  return findByName(part.side_sets, name, "side set");
}
const io::NodeSet& nodeSetOf(const io::MeshPart& part, const std::string& name) {
  return findByName(part.node_sets, name, "node set");
}

} // namespace brickwall::miniapp
