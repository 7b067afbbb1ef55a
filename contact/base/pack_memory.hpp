// Packs from and to memory. Host code.
#pragma once

#include "contact/base/pack.hpp"

#include <cstring>

namespace brickwall {

// W numbers from and to memory.
template <class Pack, class Number>
inline Pack loadPack(const Number* from) {
  Pack pack;
  memcpy(&pack.v, from, sizeof pack.v);
  return pack;
}
template <class Pack, class Number>
inline void storePack(const Pack& pack, Number* to) {
  memcpy(to, &pack.v, sizeof pack.v);
}

// W rows of three numbers each, packed, as lanes of x, y and z: `rows(k)` is the k-th of the three
// packs that they fill.
template <int W, class Rows>
KOKKOS_FORCEINLINE_FUNCTION void triplesOf(const Rows& rows, PackOf<W> (&lanes)[3]) {
  const auto a = rows(0).v, b = rows(1).v, c = rows(2).v;
  const auto part = [&](auto xyz) {
    // number(lane) is the place of the component among the 3 * W numbers
    constexpr auto number = [](int lane) { return 3 * lane + decltype(xyz)::value; };
    const auto of_ab =
        numbersOfLanes<W>([&](int lane) { return number(lane) < 2 * W ? number(lane) : 0; });
    const auto with_c =
        numbersOfLanes<W>([&](int lane) { return number(lane) < 2 * W ? lane : number(lane) - W; });
    return shuffled(shuffled(a, b, of_ab), c, with_c);
  };
  lanes[0].v = part(std::integral_constant<int, 0>());
  lanes[1].v = part(std::integral_constant<int, 1>());
  lanes[2].v = part(std::integral_constant<int, 2>());
}
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void storeTriples(const PackOf<W> (&lanes)[3], double* rows) {
  const auto &x = lanes[0].v, &y = lanes[1].v, &z = lanes[2].v;
  const auto row = [&](auto k) {
    // number(lane) = 3 * node + xyz
    constexpr auto number = [](int lane) { return W * decltype(k)::value + lane; };
    const auto of_xy =
        numbersOfLanes<W>([&](int lane) { return number(lane) / 3 + W * (number(lane) % 3 == 1); });
    const auto with_z = numbersOfLanes<W>(
        [&](int lane) { return number(lane) % 3 == 2 ? W + number(lane) / 3 : lane; });
    const auto all = shuffled(shuffled(x, y, of_xy), z, with_z);
    memcpy(rows + W * decltype(k)::value, &all, sizeof all);
  };
  row(std::integral_constant<int, 0>());
  row(std::integral_constant<int, 1>());
  row(std::integral_constant<int, 2>());
}

// Asks for a line of memory that will be read later, into the second-level cache only. (Forced
// inline as prefetch() is.)
KOKKOS_FORCEINLINE_FUNCTION void prefetchFar(const void* address) {
  __builtin_prefetch(address, 0, 2);
}

// Loads the first `count` <= W numbers, then zeros.
template <class Pack, class Number>
KOKKOS_FORCEINLINE_FUNCTION Pack loadSome(const Number* from, int count) {
  Pack pack = {};
  if (count >= static_cast<int>(sizeof pack.v / sizeof(Number)))
    return loadPack<Pack>(from);
  for (int lane = 0; lane < count; ++lane) // few: cheaper than a call of memcpy
    pack.v[lane] = from[lane];
  return pack;
}
// Stores the first `count` <= W numbers.
template <class Pack, class Number>
KOKKOS_FORCEINLINE_FUNCTION void storeSome(const Pack& pack, int count, Number* to) {
  if (count >= static_cast<int>(sizeof pack.v / sizeof(Number)))
    return storePack(pack, to);
  for (int lane = 0; lane < count; ++lane)
    to[lane] = pack.v[lane];
}

// The mask of the first `count` <= W bytes that are not zero.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION MaskPackOf<W> loadFlags(const unsigned char* from, int count) {
  typename VectorsOf<W>::bytes flags = {};
  if (count >= W)
    memcpy(&flags, from, sizeof flags);
  else
    for (int lane = 0; lane < count; ++lane)
      flags[lane] = from[lane];
  return __builtin_convertvector(flags, typename MaskPackOf<W>::vector) != 0;
}

// Loads rows of three numbers of `count` <= W nodes; the other lanes are zero. Partial rows are
// copied to an array of their own, so that the lanes of the usual case stay in registers.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void loadSomeTriples(const double* rows, int count,
                                                 PackOf<W> (&lanes)[3]) {
  if (count >= W) {
    triplesOf([&](int k) { return loadPack<PackOf<W>>(rows + W * k); }, lanes);
  } else {
    double some[3 * W] = {};
    for (int k = 0; k < 3 * count; ++k)
      some[k] = rows[k];
    triplesOf([&](int k) { return loadPack<PackOf<W>>(some + W * k); }, lanes);
  }
}
// The same for the sums of two arrays of rows.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void loadSumOfTriples(const double* a, const double* b, int count,
                                                  PackOf<W> (&lanes)[3]) {
  if (count >= W) {
    triplesOf(
        [&](int k) { return loadPack<PackOf<W>>(a + W * k) + loadPack<PackOf<W>>(b + W * k); },
        lanes);
  } else {
    double some[3 * W] = {};
    for (int k = 0; k < 3 * count; ++k)
      some[k] = a[k] + b[k];
    triplesOf([&](int k) { return loadPack<PackOf<W>>(some + W * k); }, lanes);
  }
}
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void storeSomeTriples(const PackOf<W> (&lanes)[3], int count,
                                                  double* rows) {
  if (count >= W) {
    storeTriples(lanes, rows);
  } else {
    double some[3 * W];
    storeTriples(lanes, some);
    for (int k = 0; k < 3 * count; ++k)
      rows[k] = some[k];
  }
}

} // namespace brickwall
