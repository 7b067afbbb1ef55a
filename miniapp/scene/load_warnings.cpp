#include "miniapp/scene/load_warnings.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/base/vec3.hpp"
#include "mechanics/mesh/skin.hpp"
#include "miniapp/scene/loads.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace brickwall::miniapp {

namespace {

constexpr double gauss_point = 0.57735026918962576451; // 1/sqrt(3)

// A side set relative to the centre of a gaussian.
struct Target {
  double nearest = HUGE_VAL; // distance of the nearest integration point
  double force_error = 0; // of the worst face within a radius of the nearest one
  double longest_edge = 0; // of that face
};

void addFace(double a, double b, double radius, Target& target) {
  const double error = gaussianForceError(a, b, radius);
  if (error <= target.force_error)
    return;
  target.force_error = error;
  target.longest_edge = maxOf(a, b);
}

// The side of a wall is a rectangle of equal faces (half bricks have half the elements).
Target targetOf(const WallConfig& wall, const PressureConfig& load) {
  Vec3 low, high, edge;
  for (int d = 0; d < 3; ++d) {
    const double pitch = wall.brick[d] + wall.gap;
    high[d] = static_cast<double>(wall.bricks[d]) * pitch - wall.gap;
    edge[d] = wall.brick[d] / static_cast<double>(wall.elements[d]);
    if (d == 0 && wall.ends == Ends::ragged && wall.bricks[2] > 1)
      high[d] += 0.5 * pitch;
  }
  const auto is = [&](io::WallSide side) {
    return load.side_set == io::WallLayout::sideSetName(side);
  };
  const int normal = is(io::wall_left) || is(io::wall_right)   ? 0
                     : is(io::wall_front) || is(io::wall_back) ? 1
                                                               : 2;
  if (is(io::wall_left) || is(io::wall_front) || is(io::wall_bottom))
    high[normal] = low[normal];
  else
    low[normal] = high[normal];
  Vec3 away;
  for (int d = 0; d < 3; ++d)
    away[d] = maxOf(maxOf(low[d] - load.center[d], load.center[d] - high[d]), 0.0);
  Target target;
  target.nearest = norm(away);
  addFace(edge[(normal + 1) % 3], edge[(normal + 2) % 3], load.radius, target);
  return target;
}

struct Face {
  Vec3 X[4];

  double edge(int corner) const { return norm(X[(corner + 1) % 4] - X[corner]); }
  // Distance of the nearest Gauss point.
  double distanceOf(const Vec3& centre) const {
    double nearest = HUGE_VAL;
    for (const double xi : {-gauss_point, gauss_point})
      for (const double eta : {-gauss_point, gauss_point})
        nearest =
            minOf(nearest, norm(0.25 * ((1 - xi) * (1 - eta) * X[0] + (1 + xi) * (1 - eta) * X[1] +
                                        (1 + xi) * (1 + eta) * X[2] + (1 - xi) * (1 + eta) * X[3]) -
                                centre));
    return nearest;
  }
};

Target targetOf(MPI_Comm comm, const io::MeshPart& part, const PressureConfig& load) {
  const io::SideSet& sides = sideSetOf(part, load.side_set);
  const auto faceOf = [&](std::size_t side) {
    Face face;
    for (int corner = 0; corner < 4; ++corner) {
      const int of_elem = mechanics::hex8_sides[sides.sides[side]][corner];
      const int node = part.elem_nodes[8 * static_cast<std::size_t>(sides.elems[side]) + of_elem];
      for (int d = 0; d < 3; ++d)
        face.X[corner][d] = part.coordinates[3 * static_cast<std::size_t>(node) + d];
    }
    return face;
  };
  const Vec3 centre = toVec3(load.center);
  Target target;
  for (std::size_t side = 0; side < sides.elems.size(); ++side)
    target.nearest = minOf(target.nearest, faceOf(side).distanceOf(centre));
  target.nearest = allReduce(comm, target.nearest, MPI_MIN);
  for (std::size_t side = 0; side < sides.elems.size(); ++side) {
    const Face face = faceOf(side);
    if (face.distanceOf(centre) <= target.nearest + load.radius)
      addFace(maxOf(face.edge(0), face.edge(2)), maxOf(face.edge(1), face.edge(3)), load.radius,
              target);
  }
  const double here = target.force_error;
  target.force_error = allReduce(comm, here, MPI_MAX);
  target.longest_edge =
      allReduce(comm, here == target.force_error ? target.longest_edge : 0, MPI_MAX);
  return target;
}

// Whether the deck has anything that moves a body. Bodies that overlap at the start do not push each
// other: contact acts on further penetration only.
bool setsInMotion(const Config& config) {
  const auto is_set = [](const auto& values) {
    return std::any_of(values.begin(), values.end(), [](double value) { return value != 0; });
  };
  const auto any = [](const auto& entries, const auto& acts) {
    return std::any_of(entries.begin(), entries.end(), acts);
  };
  return is_set(config.gravity) ||
         any(config.pressures, [](const PressureConfig& load) { return load.peak != 0; }) ||
         any(config.prescribed,
             [](const PrescribedVelocityConfig& moving) {
               return norm(prescribedVelocity(moving)) > 0;
             }) ||
         any(config.initial_velocities,
             [&](const InitialVelocityConfig& initial) {
               return is_set(initial.velocity) || is_set(initial.angular_velocity);
             }) ||
         any(config.initial_deformations,
             [&](const InitialDeformationConfig& initial) { return is_set(initial.gradient); });
}

// The reason why a load cannot act as intended; "" if there is none.
std::string doubtOf(const PressureConfig& load, const Target& target, double end, double dt) {
  constexpr double max_force_error = 0.05, min_share_of_peak = 1e-9;
  std::ostringstream doubt;
  const bool is_gaussian = load.distribution == Distribution::gaussian;
  const double delay = is_gaussian && load.wave_speed > 0 ? target.nearest / load.wave_speed : 0;
  const double radii = target.nearest / load.radius;
  if (!(load.pulse.start < end))
    doubt << "does nothing: it starts at " << load.pulse.start << ", but time.end is " << end;
  else if (!(load.pulse.start + delay < end))
    doubt << "does nothing: its wave reaches the nearest face of \"" << load.side_set << "\" at "
          << load.pulse.start + delay << ", but time.end is " << end;
  else if (load.pulse.duration && *load.pulse.duration < dt)
    doubt << "lasts " << *load.pulse.duration << ", less than a step of " << dt
          << ": its impulse is exact, its peak and shape are not resolved";
  else if (is_gaussian && target.force_error > max_force_error)
    doubt << "is finer than the mesh: found radius " << load.radius << " on faces of up to "
          << target.longest_edge << ", where its force may err by more than 5 %; expected at least "
          << 0.55 * target.longest_edge;
  else if (is_gaussian && std::exp(-radii * radii) < min_share_of_peak)
    doubt << "has almost no effect: the nearest face of \"" << load.side_set << "\" is "
          << target.nearest << " away from its center, " << radii << " times its radius";
  return doubt.str();
}

} // namespace

// By Poisson's summation formula, along each axis a point rule of pitch h gives the integral times
// 1 + 2 sum_k exp(-(pi k R/h)^2) cos(pi k/sqrt(3)) cos(2 pi k x_0/h); the first cosine is due to
// the positions of the two Gauss points. The terms from the third on matter only where the error
// exceeds 100 %.
double gaussianForceError(double a, double b, double radius) {
  constexpr double pi = 3.14159265358979323846, first = 0.2406, second = 0.8842;
  const auto along = [&](double edge) {
    const double ratio = pi * radius / edge, decay = std::exp(-ratio * ratio);
    return 2 * (first * decay + second * decay * decay * decay * decay);
  };
  return (1 + along(a)) * (1 + along(b)) - 1;
}

std::vector<std::string> loadWarnings(MPI_Comm comm, const Config& config, const io::MeshPart& part,
                                      double dt) {
  std::vector<std::string> warnings;
  if (!setsInMotion(config))
    warnings.emplace_back(
        "nothing will move: the deck has no load, gravity, velocity or initial deformation");
  for (std::size_t i = 0; i < config.pressures.size(); ++i) {
    const PressureConfig& load = config.pressures[i];
    Target target;
    if (load.distribution == Distribution::gaussian)
      target = config.wall ? targetOf(*config.wall, load) : targetOf(comm, part, load);
    if (load.distribution == Distribution::gaussian && target.nearest == HUGE_VAL)
      continue; // an empty set has its own warning
    const std::string doubt = doubtOf(load, target, config.time.end, dt);
    if (!doubt.empty())
      warnings.push_back("load.pressure[" + std::to_string(i) + "] " + doubt);
  }
  for (std::size_t i = 0; i < config.prescribed.size(); ++i)
    if (config.prescribed[i].pulse.start >= config.time.end) {
      std::ostringstream text;
      text << "boundary.velocity[" << i << "] only holds its nodes: it starts at "
           << config.prescribed[i].pulse.start << ", but time.end is " << config.time.end;
      warnings.push_back(text.str());
    }
  return warnings;
}

std::vector<std::string> interiorSideWarnings(MPI_Comm comm, const Config& config,
                                              const io::MeshPart& part,
                                              const mechanics::Skin& skin) {
  std::vector<std::string> warnings;
  if (config.pressures.empty())
    return warnings;
  const auto ids = toHost(skin.face_ids); // ascending
  for (const PressureConfig& load : config.pressures) {
    const io::SideSet& set = sideSetOf(part, load.side_set);
    std::int64_t counts[2] = {0, static_cast<std::int64_t>(set.elems.size())};
    for (std::size_t k = 0; k < set.elems.size(); ++k) {
      const global_id face =
          part.elem_ids[static_cast<std::size_t>(set.elems[k])] * 6 + set.sides[k];
      counts[0] += !std::binary_search(ids.data(), ids.data() + skin.num_faces, face);
    }
    allReduce(comm, counts, 2, MPI_SUM);
    if (counts[0] > 0)
      warnings.push_back("[[load.pressure]] acts inside a body: " + std::to_string(counts[0]) +
                         " of the " + std::to_string(counts[1]) + " faces of side set \"" +
                         load.side_set + "\" " + (counts[0] == 1 ? "is" : "are") +
                         " not on the surface of a body");
  }
  return warnings;
}

} // namespace brickwall::miniapp
