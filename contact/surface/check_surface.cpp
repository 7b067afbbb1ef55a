#include "contact/surface/check_surface.hpp"

#include "contact/base/hash.hpp"
#include "contact/base/region.hpp"
#include "contact/base/same_on_all_ranks.hpp"
#include "contact/base/to_device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace brickwall::contact {
namespace {

// Empty if all counts and Views are fine. Reads nothing but their sizes.
std::string problemOfSizes(const SweptBoxes& s) {
  std::string problem;
  const auto requireCount = [&](int count, const char* name) {
    if (problem.empty() && count < 0)
      problem = std::string(name) + " is " + std::to_string(count) + "; expected 0 or more";
  };
  const auto requireRows = [&](const auto& view, const char* name, int count) {
    const auto rows = static_cast<std::int64_t>(view.extent(0));
    if (problem.empty() && rows < count)
      problem =
          std::string(name) +
          (view.data() == nullptr ? " is missing" : " has " + std::to_string(rows) + " rows") +
          "; expected " + std::to_string(count) + " rows";
  };
  requireCount(s.num_nodes, "num_nodes");
  requireCount(s.num_faces, "num_faces");
  requireRows(s.coordinates_old, "coordinates_old", s.num_nodes);
  requireRows(s.coordinates_new, "coordinates_new", s.num_nodes);
  requireRows(s.node_ids, "node_ids", s.num_nodes);
  requireRows(s.node_is_owned, "node_is_owned", s.num_nodes);
  requireRows(s.node_body, "node_body", s.num_nodes);
  requireRows(s.face_to_nodes, "face_to_nodes", s.num_faces);
  requireRows(s.face_ids, "face_ids", s.num_faces);
  requireRows(s.face_body, "face_body", s.num_faces);
  if (s.face_attributes.extent(1) > 0)
    requireRows(s.face_attributes, "face_attributes", s.num_faces);
  return problem;
}

// A node and a face of the same row, all but coordinates and attributes. Sums need no order.
KOKKOS_INLINE_FUNCTION std::uint64_t hashOfRow(const SweptBoxes& s, std::int64_t row) {
  // Odd numbers without any other meaning.
  constexpr std::uint64_t a = 0x9E3779B97F4A7C15u, b = 0xC2B2AE3D27D4EB4Fu, c = 0x165667B19E3779F9u,
                          d = 0xD6E8FEB86659FD93u, e = 0xA0761D6478BD642Fu;
  const auto word = [](auto value) { return static_cast<std::uint64_t>(value); };
  std::uint64_t hash = 0;
  if (row < s.num_nodes)
    hash += hashOfWord(a * word(row) + b * word(s.node_ids(row)) + c * word(s.node_body(row)) +
                       word(s.node_is_owned(row)));
  if (row < s.num_faces)
    hash += hashOfWord(a * word(row) + b * word(s.face_ids(row)) + c * word(s.face_body(row)) +
                       d * (word(s.face_to_nodes(row, 0)) << 32 | word(s.face_to_nodes(row, 1))) +
                       e * (word(s.face_to_nodes(row, 2)) << 32 | word(s.face_to_nodes(row, 3))));
  return hash;
}

// The rows of a surface in samples, of which each has one run of rows out of num_samples runs. Long
// runs are read faster; small surfaces have short runs, so that each sample sees all parts of them.
class Samples {
public:
  static constexpr int num_samples = 16;

  explicit Samples(const SweptBoxes& s) : _num_rows(maxOf(s.num_nodes, s.num_faces)) {
    while (_log_run < 9 && (_num_rows >> _log_run) >= 64 * num_samples)
      ++_log_run;
  }
  KOKKOS_INLINE_FUNCTION int sampleOf(std::int64_t row) const {
    return static_cast<int>((row >> _log_run) % num_samples);
  }
  // Row `i` of a sample; it may lie beyond the last one.
  KOKKOS_INLINE_FUNCTION std::int64_t rowOf(std::int64_t i, int sample) const {
    const std::int64_t run = i >> _log_run;
    return ((run * num_samples + sample) << _log_run) + (i - (run << _log_run));
  }
  std::int64_t count() const {
    const std::int64_t per_round = std::int64_t(num_samples) << _log_run;
    return dividedUp(_num_rows, per_round) << _log_run;
  }
  std::int64_t numRows() const { return _num_rows; }

private:
  std::int64_t _num_rows;
  int _log_run = 4;
};

constexpr std::int64_t none = INT64_MAX;

// The lowest rows that are wrong, whether ids are out of order, and the hash of each sample.
struct Content {
  std::int64_t corner = none, node_id = none, node_body = none, face_id = none, face_body = none;
  int unordered_nodes = 0, unordered_faces = 0;
  std::uint64_t hash[Samples::num_samples] = {};

  KOKKOS_INLINE_FUNCTION Content& operator+=(const Content& b) {
    corner = minOf(corner, b.corner);
    node_id = minOf(node_id, b.node_id);
    node_body = minOf(node_body, b.node_body);
    face_id = minOf(face_id, b.face_id);
    face_body = minOf(face_body, b.face_body);
    unordered_nodes |= b.unordered_nodes;
    unordered_faces |= b.unordered_faces;
    for (int i = 0; i < Samples::num_samples; ++i)
      hash[i] += b.hash[i];
    return *this;
  }
};

struct InspectRow {
  SweptBoxes s;
  Samples samples;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, Content& found) const {
    found.hash[samples.sampleOf(row)] += hashOfRow(s, row);
    if (row < s.num_nodes) {
      requireNotNegative(s.node_ids(row), row, found.node_id);
      if (s.node_body(row) != bodyOfSide(s.node_body(row)))
        found.node_body = minOf(found.node_body, row);
      if (row > 0 && s.node_ids(row) <= s.node_ids(row - 1))
        found.unordered_nodes = 1;
    }
    if (row < s.num_faces) {
      requireNotNegative(s.face_ids(row), row, found.face_id);
      requireNotNegative(s.face_body(row), row, found.face_body);
      if (row > 0 && s.face_ids(row) <= s.face_ids(row - 1))
        found.unordered_faces = 1;
      for (int j = 0; j < 4; ++j)
        if (static_cast<unsigned>(s.face_to_nodes(row, j)) >= static_cast<unsigned>(s.num_nodes))
          found.corner = minOf(found.corner, row);
    }
  }
  KOKKOS_INLINE_FUNCTION static void requireNotNegative(global_id value, std::int64_t row,
                                                        std::int64_t& lowest) {
    if (value < 0)
      lowest = minOf(lowest, row);
  }
};

void throwIfOutside(const View<const global_id*>& values, const char* name, std::int64_t row,
                    const char* range = "0 or more") {
  if (row != none)
    throw InputError(std::string(name) + "(" + std::to_string(row) + ") is " +
                     std::to_string(toHost(values)(row)) + "; expected " + range);
}

void throwIfNoNode(const SweptBoxes& s, std::int64_t face) {
  if (face == none)
    return;
  const auto face_to_nodes = toHost(s.face_to_nodes);
  for (int j = 0; j < 4; ++j) {
    const int node = face_to_nodes(face, j);
    if (node < 0 || node >= s.num_nodes)
      throw InputError("face_to_nodes(" + std::to_string(face) + ", " + std::to_string(j) +
                       ") is " + std::to_string(node) + "; expected a node, 0 to num_nodes - 1 = " +
                       std::to_string(s.num_nodes - 1));
  }
}

// The bit of an id in a table. Ids that follow each other have bits that do so, too: tables are
// read in order where ids are.
KOKKOS_INLINE_FUNCTION std::uint64_t bitOf(global_id id, int log_bits) {
  const auto word = static_cast<std::uint64_t>(id);
  return (word + hashOfWord(word >> log_bits)) & ((std::uint64_t(1) << log_bits) - 1);
}

// Only ids whose bits are taken twice can be equal: these are few, and the host sorts them.
void throwIfRepeated(const exec_space& space, const View<const global_id*>& ids, int count,
                     const char* name) {
  int log_bits = 10;
  while ((std::int64_t(1) << log_bits) < 32 * std::int64_t(count))
    ++log_bits;
  const std::size_t num_words = std::size_t(1) << (log_bits - 5);
  const View<unsigned*> once("contact::checkSurface::once", num_words);
  const View<unsigned*> twice("contact::checkSurface::twice", num_words);
  int num_repeated = 0;
  Kokkos::parallel_reduce(
      "contact::checkSurface::takeBits", rangePolicy(space, count),
      KOKKOS_LAMBDA(const std::int64_t i, int& sum) {
        const std::uint64_t bit = bitOf(ids(i), log_bits);
        const unsigned flag = 1u << (bit & 31);
        if (Kokkos::atomic_fetch_or(&once(bit >> 5), flag) & flag) {
          Kokkos::atomic_fetch_or(&twice(bit >> 5), flag);
          ++sum;
        }
      },
      num_repeated);
  if (num_repeated == 0)
    return;
  const auto host_ids = toHost(ids);
  const auto host_twice = toHost(twice);
  std::vector<std::pair<global_id, int>> suspects;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t bit = bitOf(host_ids(i), log_bits);
    if (host_twice(bit >> 5) >> (bit & 31) & 1u)
      suspects.emplace_back(host_ids(i), i);
  }
  std::sort(suspects.begin(), suspects.end());
  for (std::size_t i = 1; i < suspects.size(); ++i) {
    const auto &a = suspects[i - 1], &b = suspects[i];
    if (a.first == b.first)
      throw InputError(std::string(name) + "(" + std::to_string(a.second) + ") and " + name + "(" +
                       std::to_string(b.second) + ") are both " + std::to_string(a.first) +
                       "; expected ids that differ");
  }
}

Content inspect(const exec_space& space, const SweptBoxes& s) {
  const Samples samples(s);
  Content found;
  Kokkos::parallel_reduce("contact::checkSurface", rangePolicy(space, samples.numRows()),
                          InspectRow{s, samples}, PlusReducer<Content>(found));
  return found;
}

Content throwIfWrong(const exec_space& space, const SweptBoxes& s) {
  const std::string problem = problemOfSizes(s);
  if (!problem.empty())
    throw InputError(problem);
  const Content found = inspect(space, s);
  throwIfNoNode(s, found.corner);
  throwIfOutside(s.node_ids, "node_ids", found.node_id);
  throwIfOutside(s.node_body, "node_body", found.node_body, "0 to 2^40 - 1");
  throwIfOutside(s.face_ids, "face_ids", found.face_id);
  throwIfOutside(s.face_body, "face_body", found.face_body);
  if (found.unordered_nodes)
    throwIfRepeated(space, s.node_ids, s.num_nodes, "node_ids");
  if (found.unordered_faces)
    throwIfRepeated(space, s.face_ids, s.num_faces, "face_ids");
  return found;
}

// Collective. Runs `check`, which throws what is wrong with this rank's surface.
template <class Check>
void throwTogether(MPI_Comm comm, const std::string& function, const Check& check) {
  rethrowOnAllRanks(comm, [&] {
    try {
      check();
    } catch (const InputError& error) {
      throw InputError(function + ": surface of rank " + std::to_string(rankOf(comm)) + ": " +
                       error.what());
    }
  });
}

} // namespace

void checkSurface(const exec_space& space, MPI_Comm comm, const std::string& function,
                  const SweptBoxes& surface) {
  const Region region("contact::checkSurface");
  throwTogether(comm, function, [&] { throwIfWrong(space, surface); });
}

namespace {

const char* nameOf(SearchMethod method) {
  switch (method) {
  case SearchMethod::cluster:
    return "cluster";
  case SearchMethod::paper:
    return "paper";
  case SearchMethod::reference:
    return "reference";
  }
  return "unknown";
}

} // namespace

void checkSearchConfig(MPI_Comm comm, const std::string& function, const SearchConfig& config,
                       double margin) {
  requireSame(comm, function,
              {{"method", std::string(nameOf(config.method))},
               {"node_tolerance", config.node_tolerance},
               {"face_tolerance", config.face_tolerance},
               {"drop_same_body", config.drop_same_body ? 1.0 : 0.0},
               {"margin", margin}});
  for (const double length : {config.node_tolerance, config.face_tolerance, margin})
    if (!(length >= 0) || !std::isfinite(length))
      throw InputError(function + ": tolerance or margin is " + std::to_string(length) +
                       "; expected a finite length, 0 or more");
}

bool SurfaceCheck::isSame(const exec_space& space, const SweptBoxes& surface) {
  if (!_is_checked || !hasSameCounts(surface) || !problemOfSizes(surface).empty())
    return false;
  if (hasSameViews(surface))
    return true;
  const Content found = inspect(space, surface);
  if (!std::equal(_hash, _hash + num_samples, found.hash))
    return false;
  remember(surface);
  return true;
}

void SurfaceCheck::startLook(const exec_space& space, const SweptBoxes& surface) {
  _sample = (_sample + 1) % num_samples;
  const Samples samples(surface);
  const int sample = _sample;
  Kokkos::parallel_reduce(
      "contact::SurfaceCheck::look", rangePolicy(space, samples.count()),
      KOKKOS_LAMBDA(const std::int64_t i, std::uint64_t& sum) {
        sum += hashOfRow(surface, samples.rowOf(i, sample));
      },
      Kokkos::Sum<std::uint64_t, staging_space>(_looked));
}

bool SurfaceCheck::looksSame(const exec_space& space) const {
  space.fence();
  return _looked() == _hash[_sample];
}

void SurfaceCheck::update(const exec_space& space, MPI_Comm comm, const std::string& function,
                          const SweptBoxes& surface, bool is_same) {
  const Region region("contact::checkSurface");
  throwTogether(comm, function, [&] {
    if (is_same)
      return;
    if (_is_checked && problemOfSizes(surface).empty()) {
      const std::string what = hasSameCounts(surface)
                                   ? "connectivity, ids, bodies or owners have changed"
                                   : "it has " + std::to_string(surface.num_nodes) + " nodes and " +
                                         std::to_string(surface.num_faces) + " faces, and had " +
                                         std::to_string(_surface.num_nodes) + " and " +
                                         std::to_string(_surface.num_faces);
      throw InputError(what + " without a call of forget(); expected other coordinates at most");
    }
    _is_checked = false;
    static_assert(num_samples == Samples::num_samples);
    const Content found = throwIfWrong(space, surface);
    std::copy(found.hash, found.hash + num_samples, _hash);
    remember(surface);
    _is_checked = true;
  });
}

bool SurfaceCheck::hasSameCounts(const SweptBoxes& surface) const {
  return surface.num_nodes == _surface.num_nodes && surface.num_faces == _surface.num_faces;
}

bool SurfaceCheck::hasSameViews(const SweptBoxes& surface) const {
  return surface.face_to_nodes.data() == _surface.face_to_nodes.data() &&
         surface.node_ids.data() == _surface.node_ids.data() &&
         surface.face_ids.data() == _surface.face_ids.data() &&
         surface.node_is_owned.data() == _surface.node_is_owned.data() &&
         surface.node_body.data() == _surface.node_body.data() &&
         surface.face_body.data() == _surface.face_body.data();
}

void SurfaceCheck::remember(const SweptBoxes& surface) {
  _surface = surface;
  _surface.coordinates_old = _surface.coordinates_new = View<const double* [3]>();
  _surface.face_attributes = ConstAttributeWords();
}

} // namespace brickwall::contact
