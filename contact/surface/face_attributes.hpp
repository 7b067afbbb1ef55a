// Data of the host that faces carry along to their ghosts: one plain struct for each face, stored
// and sent as 64-bit words, so that the search need not know what they are.
#pragma once

#include "contact/base/backend.hpp"

#include <cstdint>
#include <string>
#include <type_traits>

namespace brickwall::contact {

// Bytes, since these may hold any plain struct and be copied as such; integers may not, by the
// rules of aliasing.
struct alignas(std::int64_t) AttributeWord {
  unsigned char bytes[sizeof(std::int64_t)];
};

// [face][word]; the words of a face are contiguous.
using AttributeWords = Kokkos::View<AttributeWord**, Kokkos::LayoutRight, memory_space>;
using ConstAttributeWords = Kokkos::View<const AttributeWord**, Kokkos::LayoutRight, memory_space>;

template <class T>
constexpr int words_of = static_cast<int>(sizeof(T) / sizeof(AttributeWord));

// Row `face` of `words`, in any memory space, as the struct that it holds.
template <class T, class Words>
KOKKOS_FORCEINLINE_FUNCTION auto& attributesAt(const Words& words, std::int64_t face) {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) % sizeof(AttributeWord) == 0 &&
                alignof(T) <= alignof(AttributeWord));
  using Const = std::is_const<typename Words::value_type>;
  using Struct = typename std::conditional<Const::value, const T, T>::type;
  return *reinterpret_cast<Struct*>(&words(face, 0));
}

template <class T>
struct SetInitialAttributes {
  AttributeWords words;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t face) const {
    attributesAt<T>(words, face) = T();
  }
};

// Attributes of type T for `count` faces, with T's initial values.
template <class T>
AttributeWords allocateAttributes(const exec_space& space, const std::string& label,
                                  std::int64_t count) {
  auto words = allocate<AttributeWords>(space, label, count, words_of<T>);
  Kokkos::parallel_for("contact::allocateAttributes", rangePolicy(space, count),
                       SetInitialAttributes<T>{words});
  return words;
}

// The attributes of all faces in contact begin with these.
struct CornerMasses {
  // mass of each corner's node; infinite where its motion is prescribed
  double corner_mass[4] = {0, 0, 0, 0};
};

// Attributes of the faces of a surface.
struct FaceAttributes : CornerMasses {
  static constexpr std::int64_t unknown = -1;

  double surface_mass = 0; // mu = rho h_n/2, mass/area
  // Bit j: edge j, from corner j to the next, is a feature edge: it has no coplanar neighbour in
  // the body (edge_fading.hpp). Bit 4 + j: the body is concave at the feature edge j, or the
  // surface is bent at the edge j, which is none.
  std::int64_t feature_edges = unknown;
  KOKKOS_FORCEINLINE_FUNCTION int trueEdges() const {
    return feature_edges == unknown ? 0 : static_cast<int>(feature_edges & 15);
  }
  KOKKOS_FORCEINLINE_FUNCTION bool isBent() const {
    return feature_edges != unknown && (feature_edges >> 4 & ~feature_edges) != 0;
  }
  // The feature edges at which the body ends.
  KOKKOS_FORCEINLINE_FUNCTION int edgesOfBody() const {
    return feature_edges == unknown ? 0
                                    : static_cast<int>(feature_edges & ~(feature_edges >> 4) & 15);
  }
};

} // namespace brickwall::contact
