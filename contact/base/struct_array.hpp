// An array of structs of several words, stored word by word in packs of structs: the threads of a
// device that take consecutive structs read and write a word of all of them together. Where threads
// have SIMD lanes to fill, a pack is one struct, which lies in as few cache lines as it can.
#pragma once

#include "contact/base/backend.hpp"
#include "contact/base/to_device.hpp"

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace brickwall {

// The words of several structs. They are listed, not looped over, so that devices keep those of one
// in registers.
template <class T, int pack_size>
struct StructPack {
  using Numbers = std::make_index_sequence<sizeof(T) / 8>;
  std::int64_t words[sizeof(T) / 8][pack_size];

  KOKKOS_FORCEINLINE_FUNCTION T of(int lane) const { return of(lane, Numbers()); }
  KOKKOS_FORCEINLINE_FUNCTION void set(int lane, const T& value) { set(lane, value, Numbers()); }

private:
  template <std::size_t... w>
  KOKKOS_FORCEINLINE_FUNCTION T of(int lane, std::index_sequence<w...>) const {
    const std::int64_t own[] = {words[w][lane]...};
    T value;
    memcpy(static_cast<void*>(&value), own, sizeof value);
    return value;
  }
  template <std::size_t... w>
  KOKKOS_FORCEINLINE_FUNCTION void set(int lane, const T& value, std::index_sequence<w...>) {
    std::int64_t own[sizeof...(w)];
    memcpy(own, &value, sizeof value);
    ((words[w][lane] = own[w]), ...);
  }
};

template <class T, int pack_size = fills_lanes ? 1 : 32> // 32: the threads of a warp
class StructArray {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) % 8 == 0, "words");

public:
  static constexpr bool is_plain = pack_size == 1; // whether structs lie in memory as they are
  // What reading gives. The compiler reads no words that are not used.
  using Element = std::conditional_t<is_plain, T&, T>;

  StructArray() = default;
  explicit StructArray(const std::string& label, std::int64_t count = 0)
      : _packs(label, static_cast<std::size_t>(numPacks(count))) {}

  KOKKOS_FORCEINLINE_FUNCTION Element operator()(std::int64_t i) const {
    if constexpr (is_plain)
      return _packs(i);
    else
      return _packs(i / pack_size).of(i % pack_size);
  }
  KOKKOS_FORCEINLINE_FUNCTION void store(std::int64_t i, const T& value) const {
    if constexpr (is_plain)
      _packs(i) = value;
    else
      _packs(i / pack_size).set(i % pack_size, value);
  }
  // Sets a member that fills a word.
  KOKKOS_FORCEINLINE_FUNCTION void setMember(std::int64_t i, double T::*which, double value) const {
    if constexpr (is_plain) {
      _packs(i).*which = value;
    } else {
      const T any = T();
      const auto byte = reinterpret_cast<const unsigned char*>(&(any.*which)) -
                        reinterpret_cast<const unsigned char*>(&any);
      std::int64_t word;
      memcpy(&word, &value, 8);
      _packs(i / pack_size).words[byte / 8][i % pack_size] = word;
    }
  }
  // A struct to be written member by member: the stored one, or `local`. To be followed by
  // commit().
  KOKKOS_FORCEINLINE_FUNCTION T& edit(std::int64_t i, T& local) const {
    if constexpr (is_plain)
      return _packs(i);
    else
      return local;
  }
  KOKKOS_FORCEINLINE_FUNCTION void commit(std::int64_t i, const T& edited) const {
    if constexpr (!is_plain)
      store(i, edited);
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetch(std::int64_t i) const {
    if constexpr (is_plain)
      for (std::size_t byte = 0; byte < sizeof(T); byte += 64)
        brickwall::prefetch(reinterpret_cast<const unsigned char*>(&_packs(i)) + byte);
  }
  // The cache line of a member.
  template <class Member>
  KOKKOS_FORCEINLINE_FUNCTION void prefetch(std::int64_t i, Member T::*which) const {
    if constexpr (is_plain)
      brickwall::prefetch(&(_packs(i).*which));
  }

  // Structs that it holds.
  KOKKOS_FORCEINLINE_FUNCTION std::int64_t size() const {
    return static_cast<std::int64_t>(_packs.extent(0)) * pack_size;
  }

  // As growTo() of a View.
  void growTo(const exec_space& space, std::int64_t count) {
    brickwall::growTo(space, _packs, numPacks(count));
  }
  // A copy of the first `count`, one struct after the other. Fences.
  Kokkos::View<T*, Kokkos::HostSpace> toHost(std::int64_t count = INT64_MAX) const {
    const auto packs = brickwall::toHost(_packs);
    Kokkos::View<T*, Kokkos::HostSpace> values(
        Kokkos::view_alloc(Kokkos::WithoutInitializing, _packs.label()),
        static_cast<std::size_t>(minOf(count, size())));
    for (std::size_t i = 0; i < values.extent(0); ++i)
      if constexpr (is_plain)
        values(i) = packs(i);
      else
        values(i) = packs(i / pack_size).of(static_cast<int>(i % pack_size));
    return values;
  }
  // Copies `values` to the front. Fences.
  void assign(const std::vector<T>& values) const {
    const auto packs = Kokkos::create_mirror_view(_packs);
    for (std::size_t i = 0; i < values.size(); ++i)
      if constexpr (is_plain)
        packs(i) = values[i];
      else
        packs(i / pack_size).set(static_cast<int>(i % pack_size), values[i]);
    Kokkos::deep_copy(_packs, packs);
  }

private:
  static std::int64_t numPacks(std::int64_t count) { return dividedUp(count, pack_size); }

  View<std::conditional_t<is_plain, T, StructPack<T, pack_size>>*> _packs;
};

template <class T, int pack_size>
void growTo(const exec_space& space, StructArray<T, pack_size>& array, std::int64_t count) {
  array.growTo(space, count);
}
template <class T, int pack_size>
auto toHost(const StructArray<T, pack_size>& array) {
  return array.toHost();
}

} // namespace brickwall
