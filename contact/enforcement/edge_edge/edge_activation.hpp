// Which pairs of edges without history may come to be in contact, many pairs at once: all that EdgeEdgeKinematics::test() asks for at
// ContactTest::activate but what few pairs fail, with a little room for other rounding. First where the lines of two edges come closest
// (most pairs are near parallel, or cross beyond their ends), then, for what is left, whether that is in a depth and between the
// faces of both edges.
//
// Let t be an edge's way, a the area vector of its face, n_1 = f/|f|, f = a - (a . t) t/|t|^2, the face's normal and
// n_2 = cos n_1 + sin (t/|t| x n_1) that of the other face. A unit vector n across the edge is A n_1 + B (t/|t| x n_1) with, by
// m = t x a,
//   A = |t| (n . a)/|m|,  B = (n . m)/|m|.
#pragma once

#include "contact/enforcement/edge_edge/edge_records.hpp"
#include "contact/enforcement/law/persistent_contact.hpp"

namespace brickwall::contact {

// What the two steps ask for.
struct EdgeBirthLimits {
  double least_sine; // of the angle between the edges, and of those to their faces
  double reach; // beyond the ends of edges, in lengths
  double deepest; // of the shorter edge
  double across; // an edge that spans a side is longer than so many of its widths
};

namespace edge_births {

constexpr double slack = 1e-9; // more than rounding makes of sines that count

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

// Points of as many pairs as there are lanes: the ends of both edges, or the corners of both faces.
template <class Real, int points>
struct PointsOfPairs {
  static constexpr int width = NumLanes<Real>::value;
  double own[points][3][width], other[points][3][width];
};

template <int width>
KOKKOS_INLINE_FUNCTION void takeEnds(const EdgeRecord& edge, int lane, double (&to)[2][3][width]) {
  for (int j = 0; j < 2; ++j)
    for (int d = 0; d < 3; ++d)
      to[j][d][lane] = edge.end[j][d];
}
template <int width>
KOKKOS_INLINE_FUNCTION void takeCorners(const FaceAccess& faces, int edge, int lane,
                                        double (&to)[4][3][width]) {
  const Quad quad = faces.quad(edge);
  for (int j = 0; j < 4; ++j)
    for (int d = 0; d < 3; ++d)
      to[j][d][lane] = quad.corner[j][d];
}

// Lanes whose lines come closest on both edges.
template <class Real>
KOKKOS_INLINE_FUNCTION unsigned lanesAcross(const PointsOfPairs<Real, 2>& ends,
                                            const EdgeBirthLimits& limits) {
  const Triple<Real> a = loadTriple<Real>(ends.own[0]), b = loadTriple<Real>(ends.other[0]);
  const Triple<Real> da = loadTriple<Real>(ends.own[1]) - a;
  const Triple<Real> db = loadTriple<Real>(ends.other[1]) - b, between = a - b;
  const Real aa = dot(da, da), bb = dot(db, db), ab = dot(da, db);
  const Real ra = dot(da, between), rb = dot(db, between), determinant = aa * bb - ab * ab;
  // s and t times the determinant, which is > 0 where that matters
  const Real s = ab * rb - bb * ra, t = aa * rb - ab * ra;
  const double least = (1 - slack) * limits.least_sine * limits.least_sine;
  const Real past = (limits.reach + 1e-6) * determinant;
  const auto is_out = (determinant <= least * (aa * bb)) | (s < -past) | (s > determinant + past) |
                      (t < -past) | (t > determinant + past);
  return bitsOf(!is_out);
}

// n in the frame of an edge, and where that is against its cone.
template <class Real>
struct InCone {
  using Mask = typename MaskOf<Real>::type;
  Real along_first, beside_first; // A and B
  Real cosine, sine;

  KOKKOS_INLINE_FUNCTION InCone(const double (&corner)[4][3][NumLanes<Real>::value],
                                const Triple<Real>& way, const Real& squared_length,
                                const Triple<Real>& n, const Real& cos, const Real& sin)
      : cosine(cos), sine(sin) {
    const Triple<Real> area = cross(loadTriple<Real>(corner[2]) - loadTriple<Real>(corner[0]),
                                    loadTriple<Real>(corner[3]) - loadTriple<Real>(corner[1]));
    const Triple<Real> beside = cross(way, area);
    const Real scale = Real(1.0) / squareRoot(dot(beside, beside));
    along_first = squareRoot(squared_length) * dot(n, area) * scale;
    beside_first = dot(n, beside) * scale;
  }
  // (n_1 + n_2) . n
  KOKKOS_INLINE_FUNCTION Real outward() const {
    return (1.0 + cosine) * along_first + sine * beside_first;
  }
  // Whether `sign` n is less than `sine` inside, as EdgeCone::depthOf() finds it.
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
  static constexpr int width = NumLanes<Real>::value;
  PointsOfPairs<Real, 4> corners;
  double cosine[2][width], sine[2][width]; // of own and other
  double narrower[2][width]; // width of the sides of own and other, the lesser one
};

// Whether `sign` n does not lead out of an edge: it is less than least_sine inside the cone, and not on its rim either where the
// other edge, of this squared length, may span a side.
template <class Real>
KOKKOS_INLINE_FUNCTION typename MaskOf<Real>::type
leadsIn(const InCone<Real>& cone, const Real& sign, const Real& squared_length,
        const Real& narrower, const EdgeBirthLimits& limits) {
  const double across = (1 - slack) * limits.across;
  const auto is_short = squared_length < across * across * narrower * narrower;
  return cone.isOutside(sign, -limits.least_sine) |
         (is_short & cone.isOutside(sign, limits.least_sine));
}

// Lanes whose edges have crossed, between their faces; of edges that lanesAcross() has let pass.
template <class Real>
KOKKOS_INLINE_FUNCTION unsigned lanesInDepth(const Surroundings<Real>& pairs,
                                             const EdgeBirthLimits& limits) {
  const auto& own = pairs.corners.own;
  const auto& other = pairs.corners.other;
  const Triple<Real> a = loadTriple<Real>(own[0]), b = loadTriple<Real>(other[0]);
  const Triple<Real> da = loadTriple<Real>(own[1]) - a, db = loadTriple<Real>(other[1]) - b;
  const Triple<Real> across = cross(da, db), between = a - b;
  const Triple<Real> normal = (Real(1.0) / squareRoot(dot(across, across))) * across;
  const Real depth = -dot(between, normal), aa = dot(da, da), bb = dot(db, db);
  const InCone<Real> in_own(own, da, aa, normal, loadLanes<Real>(pairs.cosine[0]),
                            loadLanes<Real>(pairs.sine[0]));
  const InCone<Real> in_other(other, db, bb, normal, loadLanes<Real>(pairs.cosine[1]),
                              loadLanes<Real>(pairs.sine[1]));
  const Real outward = in_other.outward(), zero = 0.0;
  const Real sign = where(outward < zero, Real(-1.0), Real(1.0)); // of the normal out of the other
  const double deepest = (1 + slack) * limits.deepest * limits.deepest;
  const auto is_out = (depth * depth > deepest * aa) | (depth * depth > deepest * bb) |
                      ((outward > Real(slack)) & (depth <= zero)) |
                      ((outward < Real(-slack)) & (-depth <= zero)) | // -n is the normal
                      leadsIn(in_own, -sign, bb, loadLanes<Real>(pairs.narrower[0]), limits) |
                      leadsIn(in_other, sign, aa, loadLanes<Real>(pairs.narrower[1]), limits);
  return bitsOf(!is_out);
}

// Pairs that are tested together as soon as they fill the lanes.
template <class Real>
struct Waiting {
  static constexpr int width = NumLanes<Real>::value;
  int own[width], other[width], row[width];
  int count = 0;

  KOKKOS_INLINE_FUNCTION bool add(int of_row, int own_edge, int other_edge) {
    row[count] = of_row;
    own[count] = own_edge;
    other[count] = other_edge;
    return ++count == width;
  }
  KOKKOS_INLINE_FUNCTION int at(int lane) const { return minOf(lane, count - 1); }
};

} // namespace edge_births

// Takes pairs, and keeps the rows of those that may come to be in contact.
template <class Real>
struct EdgeBirths {
  static constexpr int width = NumLanes<Real>::value;
  const FaceAccess& faces;
  const EdgeRecords& records;
  EdgeBirthLimits limits;
  unsigned rows = 0; // bit r: row r has such a pair
  edge_births::Waiting<Real> near, crossed;

  // `row` < 32 is the caller's number for the row of edge `own`.
  KOKKOS_INLINE_FUNCTION void add(int row, int own, int other) {
    if (near.add(row, own, other))
      testNear();
  }
  // To be called at the end.
  KOKKOS_INLINE_FUNCTION void finish() {
    if (near.count > 0)
      testNear();
    if (crossed.count > 0)
      testCrossed();
  }

private:
  KOKKOS_FORCEINLINE_FUNCTION void prefetchEdge(int edge) const {
    faces.prefetchFace(edge);
    for (int j = 2; j < 4; ++j)
      if (faces.isOwn(edge))
        faces.prefetchRow(faces.surface.coordinates_new, faces.surface.face_to_nodes(edge, j));
  }
  KOKKOS_FORCEINLINE_FUNCTION double narrowerSide(int edge) const {
    const EdgeAttributes& attributes = faces.attributes<EdgeAttributes>(edge);
    return minOf(attributes.width[0], attributes.width[1]);
  }
  KOKKOS_INLINE_FUNCTION void testNear() {
    edge_births::PointsOfPairs<Real, 2> ends;
    for (int lane = 0; lane < width; ++lane) {
      edge_births::takeEnds(records.of(near.own[near.at(lane)]), lane, ends.own);
      edge_births::takeEnds(records.of(near.other[near.at(lane)]), lane, ends.other);
    }
    const unsigned lanes = edge_births::lanesAcross<Real>(ends, limits);
    for (int lane = 0; lane < near.count; ++lane)
      if ((lanes >> lane & 1u) && !(rows >> near.row[lane] & 1u)) {
        prefetchEdge(near.own[lane]);
        prefetchEdge(near.other[lane]);
        if (crossed.add(near.row[lane], near.own[lane], near.other[lane]))
          testCrossed();
      }
    near.count = 0;
  }
  KOKKOS_INLINE_FUNCTION void testCrossed() {
    edge_births::Surroundings<Real> pairs;
    for (int lane = 0; lane < width; ++lane) {
      const int own = crossed.own[crossed.at(lane)], other = crossed.other[crossed.at(lane)];
      edge_births::takeCorners(faces, own, lane, pairs.corners.own);
      edge_births::takeCorners(faces, other, lane, pairs.corners.other);
      pairs.cosine[0][lane] = faces.attributes<EdgeAttributes>(own).cosine;
      pairs.sine[0][lane] = faces.attributes<EdgeAttributes>(own).sine;
      pairs.cosine[1][lane] = faces.attributes<EdgeAttributes>(other).cosine;
      pairs.sine[1][lane] = faces.attributes<EdgeAttributes>(other).sine;
      pairs.narrower[0][lane] = narrowerSide(own);
      pairs.narrower[1][lane] = narrowerSide(other);
    }
    const unsigned lanes = edge_births::lanesInDepth<Real>(pairs, limits);
    for (int lane = 0; lane < crossed.count; ++lane)
      rows |= (lanes >> lane & 1u) << crossed.row[lane];
    crossed.count = 0;
  }
};

} // namespace brickwall::contact
