// Quick rejection of pairs of edges without history, as many at once as there are SIMD lanes: all
// tests of EdgeEdgeKinematics::test() at ContactTest::activate that most pairs fail, with some
// slack for different rounding. First the closest points of the two lines (most pairs are nearly
// parallel, or cross beyond their ends); then, for the remaining pairs, the penetration and the
// cones of both edges. Eqs. (29) and (30) of theory.md.
//
// Let t be an edge vector, a the area vector of its face, n_1 = f/|f|, f = a - (a . t) t/|t|^2, the
// face's normal and n_2 = cos n_1 + sin (t/|t| x n_1) that of the other face. A unit vector n
// perpendicular to the edge is A n_1 + B (t/|t| x n_1) with, by m = t x a,
//     A = |t| (n . a)/|m|,  B = (n . m)/|m|.
#pragma once

#include "contact/enforcement/edge_edge/edge_surface.hpp"
#include "contact/enforcement/law/persistent_contact.hpp"

namespace brickwall::contact {

// Limits of the two tests.
struct EdgeActivationLimits {
  double least_sine; // of the angle between the edges, and of those to their faces
  double reach; // beyond the ends of edges, in lengths of the edge
  double deepest; // penetration over the length of the shorter edge
  double overhang; // beyond a side and its ends of an edge that spans it, in widths or lengths
};

namespace edge_activation {

constexpr double slack = 1e-9; // above the rounding error of the sines

// Bit l: lane l of a comparison.
KOKKOS_INLINE_FUNCTION unsigned bitsOf(bool mask) {
  return mask ? 1 : 0;
}
template <int W>
inline unsigned bitsOf(const MaskPackOf<W>& mask) {
  unsigned bits = 0;
  for (int lane = 0; lane < W; ++lane)
    bits |= static_cast<unsigned>(mask.v[lane] & 1) << lane;
  return bits;
}

// The ends of both edges, or the corners of both faces.
template <class Real, int points>
struct PointsOfPairs {
  LaneTriple<Real> own[points], other[points];
};

template <class Real>
KOKKOS_INLINE_FUNCTION void takeEnds(const EdgeRecord& edge, int lane, LaneTriple<Real> (&to)[2]) {
  for (int j = 0; j < 2; ++j)
    to[j].set(lane, {edge.end[j][0], edge.end[j][1], edge.end[j][2]});
}
template <class Real>
KOKKOS_INLINE_FUNCTION void takeCorners(const FaceAccess& faces, int edge, int lane,
                                        LaneTriple<Real> (&to)[4]) {
  const Quad quad = faces.quad(edge);
  for (int j = 0; j < 4; ++j)
    to[j].set(lane, quad.corner[j]);
}

// Lanes whose lines have their closest points on both edges.
template <class Real>
KOKKOS_INLINE_FUNCTION unsigned lanesAcross(const PointsOfPairs<Real, 2>& ends,
                                            const EdgeActivationLimits& limits) {
  const Triple<Real> a = ends.own[0], b = ends.other[0];
  const Triple<Real> da = Triple<Real>(ends.own[1]) - a, db = Triple<Real>(ends.other[1]) - b;
  const Triple<Real> between = a - b;
  const Real aa = dot(da, da), bb = dot(db, db), ab = dot(da, db);
  const Real ra = dot(da, between), rb = dot(db, between), determinant = aa * bb - ab * ab;
  // s and t times the determinant, which is > 0 where they are used
  const Real s = ab * rb - bb * ra, t = aa * rb - ab * ra;
  const double least = (1 - slack) * limits.least_sine * limits.least_sine;
  const Real past = (limits.reach + 1e-6) * determinant;
  const auto is_rejected = (determinant <= least * (aa * bb)) | (s < -past) |
                           (s > determinant + past) | (t < -past) | (t > determinant + past);
  return bitsOf(!is_rejected);
}

// The components of n in the frame of an edge, and its position with respect to the edge's cone.
template <class Real>
struct InCone {
  using Mask = typename MaskOf<Real>::type;
  Real along_first, beside_first; // A and B
  Real cosine, sine;

  KOKKOS_INLINE_FUNCTION InCone(const LaneTriple<Real> (&corner)[4],
                                const Triple<Real>& edge_vector, const Real& squared_length,
                                const Triple<Real>& n, const Real& cos, const Real& sin)
      : cosine(cos), sine(sin) {
    const Triple<Real> area = cross(Triple<Real>(corner[2]) - Triple<Real>(corner[0]),
                                    Triple<Real>(corner[3]) - Triple<Real>(corner[1]));
    const Triple<Real> beside = cross(edge_vector, area);
    const Real scale = Real(1.0) / squareRoot(dot(beside, beside));
    along_first = squareRoot(squared_length) * dot(n, area) * scale;
    beside_first = dot(n, beside) * scale;
  }
  // (n_1 + n_2) . n
  KOKKOS_INLINE_FUNCTION Real outward() const {
    return (1.0 + cosine) * along_first + sine * beside_first;
  }
  // Whether `sign` n is less than `least_sine` inside the cone, as EdgeCone::depthOf() computes it.
  KOKKOS_INLINE_FUNCTION Mask isOutside(const Real& sign, double least_sine) const {
    const Real a = sign * along_first, from_first = sign * beside_first;
    const Real to_second = a * sine - from_first * cosine;
    const Real along_second = cosine * a + sine * from_first;
    const double least = least_sine - slack;
    return (sign * outward() < Real(-slack)) |
           (((a > Real(0.0)) | (from_first < Real(-slack))) & (from_first < Real(least))) |
           (((along_second > Real(0.0)) | (to_second < Real(-slack))) & (to_second < Real(least)));
  }
};

template <class Real>
struct Surroundings {
  PointsOfPairs<Real, 4> corners;
  LaneArray<Real> cosine[2], sine[2]; // of own and other
  LaneArray<Real> narrower[2]; // the smaller width of the sides of own and other
};

// Whether an edge cannot span a side of another one (EdgeEdgeKinematics::isSpanned()): it is
// shorter than the side is wide, with the overhangs, and ends within the length of the other edge.
// `first`: from the first end of the other edge to that of this one.
template <class Real>
KOKKOS_INLINE_FUNCTION typename MaskOf<Real>::type
cannotSpan(const Triple<Real>& edge, const Triple<Real>& first, const Triple<Real>& other,
           const Real& narrower, const EdgeActivationLimits& limits) {
  const double across = (1 - slack) * (1 + 2 * limits.overhang);
  const Real square = dot(other, other), over = (limits.overhang - 1e-6) * square;
  const Real one_end = dot(first, other) + over, other_end = one_end + dot(edge, other);
  const Real most = square + 2.0 * over, zero = 0.0;
  return (dot(edge, edge) < across * across * narrower * narrower) & (zero <= one_end) &
         (zero <= other_end) & (one_end <= most) & (other_end <= most);
}
// Whether `sign` n does not lead out of an edge: it is less than least_sine inside the cone, and
// not on its rim where the other edge may span a side.
template <class Real, class Mask>
KOKKOS_INLINE_FUNCTION Mask leadsIn(const InCone<Real>& cone, const Real& sign,
                                    const Mask& cannot_span, const EdgeActivationLimits& limits) {
  return cone.isOutside(sign, -limits.least_sine) |
         (cannot_span & cone.isOutside(sign, limits.least_sine));
}

// Lanes whose edges have crossed, with the normal inside both cones; for edges that pass
// lanesAcross().
template <class Real>
KOKKOS_INLINE_FUNCTION unsigned lanesInDepth(const Surroundings<Real>& pairs,
                                             const EdgeActivationLimits& limits) {
  const auto& own = pairs.corners.own;
  const auto& other = pairs.corners.other;
  const Triple<Real> a = own[0], b = other[0];
  const Triple<Real> da = Triple<Real>(own[1]) - a, db = Triple<Real>(other[1]) - b;
  const Triple<Real> across = cross(da, db), between = a - b;
  const Triple<Real> normal = (Real(1.0) / squareRoot(dot(across, across))) * across;
  const Real depth = -dot(between, normal), aa = dot(da, da), bb = dot(db, db);
  const InCone<Real> in_own(own, da, aa, normal, Real(pairs.cosine[0]), Real(pairs.sine[0]));
  const InCone<Real> in_other(other, db, bb, normal, Real(pairs.cosine[1]), Real(pairs.sine[1]));
  const Real outward = in_other.outward(), zero = 0.0;
  // of the normal that leads out of the other edge
  const Real sign = where(outward < zero, Real(-1.0), Real(1.0));
  const auto own_is_short = cannotSpan(da, between, db, Real(pairs.narrower[1]), limits);
  const auto other_is_short =
      cannotSpan(db, Real(-1.0) * between, da, Real(pairs.narrower[0]), limits);
  const double deepest = (1 + slack) * limits.deepest * limits.deepest;
  const auto is_rejected = (depth * depth > deepest * aa) | (depth * depth > deepest * bb) |
                           ((outward > Real(slack)) & (depth <= zero)) |
                           ((outward < Real(-slack)) & (-depth <= zero)) | // -n is the normal
                           leadsIn(in_own, -sign, other_is_short, limits) |
                           leadsIn(in_other, sign, own_is_short, limits);
  return bitsOf(!is_rejected);
}

// Pairs that are tested together as soon as they fill the lanes.
template <class Real>
struct Waiting {
  static constexpr int width = NumLanes<Real>::value;
  int own[width], other[width], row[width];
  int count = 0;

  KOKKOS_INLINE_FUNCTION bool add(int of_row, int own_edge, int other_edge) {
    const int place = width > 1 ? count : 0;
    row[place] = of_row;
    own[place] = own_edge;
    other[place] = other_edge;
    return ++count == width;
  }
  // A lane that has a pair. Constant with one lane, so that the arrays are registers.
  KOKKOS_FORCEINLINE_FUNCTION int at(int lane) const {
    return width > 1 ? minOf(lane, count - 1) : 0;
  }
};

} // namespace edge_activation

// Receives pairs and flags the rows of those that may become active.
template <class Real>
struct EdgeActivationTest {
  static constexpr int width = NumLanes<Real>::value;
  const FaceAccess& faces;
  const EdgeRecords& records;
  EdgeActivationLimits limits;
  unsigned rows = 0; // bit r: row r has such a pair
  edge_activation::Waiting<Real> waiting, crossed;

  // `row` < 32 is the caller's number for the row of edge `own`.
  KOKKOS_INLINE_FUNCTION void add(int row, int own, int other) {
    if (waiting.add(row, own, other))
      testNear();
  }
  // Tests the remaining pairs; to be called at the end.
  KOKKOS_INLINE_FUNCTION void finish() {
    if (waiting.count > 0)
      testNear();
    if (crossed.count > 0)
      testCrossed();
  }

private:
  KOKKOS_FORCEINLINE_FUNCTION void prefetchEdge(int edge) const {
    faces.prefetchFace(edge);
    for (int j = 2; j < 4; ++j)
      if (faces.isOwn(edge))
        prefetchRow(faces.surface.coordinates_new, faces.surface.face_to_nodes(edge, j));
  }
  KOKKOS_FORCEINLINE_FUNCTION double narrowerSide(int edge) const {
    const EdgeAttributes& attributes = faces.attributes<EdgeAttributes>(edge);
    return minOf(attributes.width[0], attributes.width[1]);
  }
  KOKKOS_INLINE_FUNCTION void testNear() {
    edge_activation::PointsOfPairs<Real, 2> ends;
    for (int lane = 0; lane < width; ++lane) {
      edge_activation::takeEnds(records.of(waiting.own[waiting.at(lane)]), lane, ends.own);
      edge_activation::takeEnds(records.of(waiting.other[waiting.at(lane)]), lane, ends.other);
    }
    const unsigned lanes = edge_activation::lanesAcross<Real>(ends, limits);
    for (int lane = 0; lane < waiting.count; ++lane)
      if ((lanes >> lane & 1u) && !(rows >> waiting.row[lane] & 1u)) {
        prefetchEdge(waiting.own[lane]);
        prefetchEdge(waiting.other[lane]);
        if (crossed.add(waiting.row[lane], waiting.own[lane], waiting.other[lane]))
          testCrossed();
      }
    waiting.count = 0;
  }
  KOKKOS_INLINE_FUNCTION void testCrossed() {
    edge_activation::Surroundings<Real> pairs;
    for (int lane = 0; lane < width; ++lane) {
      const int own = crossed.own[crossed.at(lane)], other = crossed.other[crossed.at(lane)];
      edge_activation::takeCorners(faces, own, lane, pairs.corners.own);
      edge_activation::takeCorners(faces, other, lane, pairs.corners.other);
      pairs.cosine[0][lane] = faces.attributes<EdgeAttributes>(own).cosine;
      pairs.sine[0][lane] = faces.attributes<EdgeAttributes>(own).sine;
      pairs.cosine[1][lane] = faces.attributes<EdgeAttributes>(other).cosine;
      pairs.sine[1][lane] = faces.attributes<EdgeAttributes>(other).sine;
      pairs.narrower[0][lane] = narrowerSide(own);
      pairs.narrower[1][lane] = narrowerSide(other);
    }
    const unsigned lanes = edge_activation::lanesInDepth<Real>(pairs, limits);
    for (int lane = 0; lane < crossed.count; ++lane)
      rows |= (lanes >> lane & 1u) << crossed.row[lane];
    crossed.count = 0;
  }
};

} // namespace brickwall::contact
