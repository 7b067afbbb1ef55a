// Kept lists are complete: theory.md, section 2. Only T and D themselves must be correct, so D is
// compared with the difference of the T and t used, less a few units in the last place for the
// rounding of T - t and of D.
#include "contact/search/candidate_search.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/base/vec3.hpp"

#include <cfloat>
#include <cmath>

namespace brickwall::contact {
namespace {

Communicator checkedCopy(MPI_Comm comm, const SearchConfig& config, double margin) {
  checkSearchConfig(comm, "CandidateSearch", config, margin);
  return Communicator(comm);
}

// A tolerance that is negative stays so, for GlobalSearch to refuse.
SearchConfig withMargin(SearchConfig config, double margin) {
  for (double* tolerance : {&config.node_tolerance, &config.face_tolerance})
    if (*tolerance >= 0)
      *tolerance += 0.5 * margin;
  return config;
}

// The distance by which nodes of this rank have left the swept boxes of the last search, in either
// configuration of the step. Stationary nodes have not left them farther than in the last step.
double motionOutOf(const exec_space& space, const View<const double* [6]>& boxes,
                   const SweptBoxes& surface, const View<const unsigned char*>& stationary) {
  const auto x_old = surface.coordinates_old, x_new = surface.coordinates_new;
  const bool has_flags = stationary.extent(0) > 0;
  double largest = 0;
  Kokkos::parallel_reduce(
      "contact::CandidateSearch::largestMotion", rangePolicy(space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, double& all) {
        if (!has_flags || stationary(node) == 0)
          all = maxOf(all, excursionOutside(boxes, node, rowOf(x_old, node), rowOf(x_new, node)));
      },
      Kokkos::Max<double>(largest));
  return largest;
}

void keepSweptBoxes(const exec_space& space, const SweptBoxes& surface, View<double* [6]>& boxes) {
  growTo(space, boxes, surface.num_nodes);
  const auto x_old = surface.coordinates_old, x_new = surface.coordinates_new;
  const auto searched_at = boxes;
  Kokkos::parallel_for(
      "contact::CandidateSearch::keepSweptBoxes", rangePolicy(space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int d = 0; d < 3; ++d) {
          searched_at(node, d) = minOf(x_old(node, d), x_new(node, d));
          searched_at(node, 3 + d) = maxOf(x_old(node, d), x_new(node, d));
        }
      });
}

} // namespace

CandidateSearch::CandidateSearch(MPI_Comm comm, const SearchConfig& config, double margin)
    : _comm(checkedCopy(comm, config, margin)), _config(config), _margin(margin),
      _global(_comm, withMargin(config, margin)), _local(_global) {
  applyTolerances();
}

void CandidateSearch::setTolerances(double node_tolerance, double face_tolerance) {
  if (node_tolerance == _config.node_tolerance && face_tolerance == _config.face_tolerance)
    return;
  _config.node_tolerance = node_tolerance;
  _config.face_tolerance = face_tolerance;
  applyTolerances();
  _has_lists = false;
}

void CandidateSearch::applyTolerances() {
  const SearchConfig wide = withMargin(_config, _margin);
  _global.setTolerances(wide.node_tolerance, wide.face_tolerance);
  _local.setStepTest({_margin > 0, _config.node_tolerance, _config.face_tolerance});
  _allowed_motion = (1 - 4 * DBL_EPSILON) * minOf(wide.node_tolerance - _config.node_tolerance,
                                                  wide.face_tolerance - _config.face_tolerance);
}

const CandidatePairs& CandidateSearch::update(const exec_space& space, const SweptBoxes& surface,
                                              std::optional<double> motion,
                                              const std::function<void()>& meanwhile,
                                              const View<const unsigned char*>& stationary) {
  keepOrSearch(space, surface, _has_pairs ? motion : HUGE_VAL, stationary, [&] {
    _global.launchGhosts(space, surface);
    _local.findCandidatePairs(space, surface, meanwhile);
    _global.finishGhosts(space, surface);
    _has_pairs = true;
  });
  return _local.pairs();
}

const GhostFaces& CandidateSearch::updateGhosts(const exec_space& space, const SweptBoxes& surface,
                                                std::optional<double> motion,
                                                const View<const unsigned char*>& stationary) {
  keepOrSearch(space, surface, motion, stationary, [&] { _global.findGhosts(space, surface); });
  return _global.ghosts();
}

template <class Search>
void CandidateSearch::keepOrSearch(const exec_space& space, const SweptBoxes& surface,
                                   std::optional<double> motion,
                                   const View<const unsigned char*>& stationary,
                                   const Search& search) {
  if (mayKeepLists(space, surface, motion, stationary)) {
    _global.forwardCoordinates(space, surface);
    return;
  }
  _has_lists = _has_pairs = false; // in case of a throw
  search();
  if (_margin > 0)
    keepSweptBoxes(space, surface, _searched_at);
  _has_lists = true;
  ++_searches;
}

// Counts an update. A coordinate that is not finite makes all ranks search, which reports it.
bool CandidateSearch::mayKeepLists(const exec_space& space, const SweptBoxes& surface,
                                   std::optional<double> motion,
                                   const View<const unsigned char*>& stationary) {
  ++_updates;
  if (_margin == 0)
    return false;
  const Region region("contact::measureMotion");
  double here = HUGE_VAL;
  if (_has_lists && _global.isSame(space, surface))
    here = motion ? *motion : motionOutOf(space, _searched_at, surface, stationary);
  // negative without nodes
  return allReduce(_comm, maxOf(here, 0.0), MPI_MAX) <= _allowed_motion;
}

void CandidateSearch::restore(const exec_space& space, const SweptBoxes& surface,
                              std::int64_t searches, std::int64_t updates) {
  _has_lists = _has_pairs = false;
  const int has_boxes = surface.num_nodes == 0 || surface.coordinates_new.extent(0) > 0;
  if (allReduce(_comm, has_boxes, MPI_MIN) == 1 && _margin > 0)
    update(space, surface, HUGE_VAL);
  _searches = searches;
  _updates = updates;
}

} // namespace brickwall::contact
