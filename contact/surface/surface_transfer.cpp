#include "contact/surface/surface_transfer.hpp"

#include "contact/base/scan.hpp"
#include "contact/base/tags.hpp"
#include "contact/base/to_device.hpp"

#include <utility>

namespace brickwall::contact {
namespace {

constexpr std::int64_t word_bits = 64;

// Bit i of word w is the flag of the i-th row of the word.
void packFlags(const exec_space& space, const SurfaceTransfer::Flags& flags, const View<int*>& rows,
               const View<int*>& word_begin, const View<std::int64_t*>& words) {
  Kokkos::parallel_for(
      "contact::SurfaceTransfer::packFlags",
      rangePolicy(space, static_cast<std::int64_t>(word_begin.extent(0)) - 1),
      KOKKOS_LAMBDA(const std::int64_t w) {
        std::uint64_t word = 0;
        for (int i = word_begin(w); i < word_begin(w + 1); ++i)
          word |= std::uint64_t(flags(rows(i)) != 0) << (i - word_begin(w));
        words(w) = static_cast<std::int64_t>(word);
      });
}
void unpackFlags(const exec_space& space, const View<std::int64_t*>& words, const View<int*>& rows,
                 const View<int*>& word_begin, const SurfaceTransfer::Flags& flags) {
  Kokkos::parallel_for(
      "contact::SurfaceTransfer::unpackFlags",
      rangePolicy(space, static_cast<std::int64_t>(word_begin.extent(0)) - 1),
      KOKKOS_LAMBDA(const std::int64_t w) {
        const auto word = static_cast<std::uint64_t>(words(w));
        for (int i = word_begin(w); i < word_begin(w + 1); ++i)
          if ((word >> (i - word_begin(w)) & 1) != 0)
            flags(rows(i)) = 1;
      });
}

void copyFlags(const exec_space& space, const SurfaceTransfer::Flags& source,
               const SurfaceTransfer::Flags& target, const View<int*>& from, const View<int*>& to) {
  Kokkos::parallel_for(
      "contact::SurfaceTransfer::copyFlags",
      rangePolicy(space, static_cast<std::int64_t>(from.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t i) {
        if (source(from(i)))
          target(to(i)) = 1;
      });
}

} // namespace

SurfaceTransfer::Side::Side(const exec_space& space,
                            const std::vector<std::vector<int>>& of_partners)
    : ends(1, 0), word_ends(1, 0) {
  std::vector<int> all, begin;
  for (const auto& rows_of_partner : of_partners) {
    all.insert(all.end(), rows_of_partner.begin(), rows_of_partner.end());
    const std::int64_t end = checkedInt(static_cast<std::int64_t>(all.size()), "rows of partners");
    for (std::int64_t row = ends.back(); row < end; row += word_bits)
      begin.push_back(static_cast<int>(row));
    ends.push_back(end);
    word_ends.push_back(static_cast<std::int64_t>(begin.size()));
  }
  begin.push_back(static_cast<int>(ends.back()));
  selected_ends.assign(ends.size(), 0);
  rows = toDevice(space, "contact::SurfaceTransfer::rows", all);
  word_begin = toDevice(space, "contact::SurfaceTransfer::word_begin", begin);
  place = allocate<View<int*>>(space, "contact::SurfaceTransfer::place", all.size() + 1);
  host_place = Kokkos::create_mirror_view(place);
  selected = allocate<View<int*>>(space, "contact::SurfaceTransfer::selected", all.size());
}

void SurfaceTransfer::Side::select(const exec_space& space, const Flags& flags) {
  listFlagged(space, "contact::SurfaceTransfer::list", View<const unsigned char*>(flags), rows,
              static_cast<std::int64_t>(rows.extent(0)), selected, place);
  Kokkos::deep_copy(space, host_place, place);
  space.fence();
  selected_ends.clear();
  for (const std::int64_t end : ends)
    selected_ends.push_back(host_place(end));
}

SurfaceTransfer::SurfaceTransfer(const exec_space& space, const Communicator& comm,
                                 std::vector<std::vector<int>> from_rows,
                                 std::vector<std::vector<int>> to_rows)
    : _comm(comm), _tag(tags::secondary_surface) {
  const int rank = rankOf(comm);
  _from = toDevice(space, "contact::SurfaceTransfer::from", from_rows[rank]);
  _to = toDevice(space, "contact::SurfaceTransfer::to", to_rows[rank]);
  _selected_from =
      allocate<View<int*>>(space, "contact::SurfaceTransfer::selected_from", _from.extent(0));
  _selected_to =
      allocate<View<int*>>(space, "contact::SurfaceTransfer::selected_to", _from.extent(0));
  from_rows[rank].clear();
  to_rows[rank].clear();
  std::vector<int> partners;
  std::vector<std::vector<int>> sent, received;
  for (int q = 0; q < sizeOf(comm); ++q)
    if (!from_rows[q].empty() || !to_rows[q].empty()) {
      partners.push_back(q);
      sent.push_back(std::move(from_rows[q]));
      received.push_back(std::move(to_rows[q]));
    }
  _sent = Side(space, sent);
  _received = Side(space, received);
  _plan = ExchangePlan(space, comm, _tag, partners, sent, received);
}

void SurfaceTransfer::forwardFlags(const exec_space& space, const Flags& source,
                                   const Flags& target) {
  copyFlags(space, source, target, _from, _to);
  if (_plan.partners().empty())
    return;
  growTo(space, _buffers.send, _sent.word_ends.back());
  packFlags(space, source, _sent.rows, _sent.word_begin, _buffers.send);
  _buffers.exchange(space, _comm, _tag, _plan.partners(), _sent.word_ends, _received.word_ends);
  unpackFlags(space, _buffers.receive, _received.rows, _received.word_begin, target);
}

void SurfaceTransfer::select(const exec_space& space, const Flags& source, const Flags& target) {
  _sent.select(space, source);
  _received.select(space, target);
  const auto from = _from, to = _to, selected_from = _selected_from, selected_to = _selected_to;
  Kokkos::parallel_scan(
      "contact::SurfaceTransfer::selectOwn",
      rangePolicy(space, static_cast<std::int64_t>(_from.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t i, int& sum, const bool is_final) {
        if (source(from(i)) == 0)
          return;
        if (is_final) {
          selected_from(sum) = from(i);
          selected_to(sum) = to(i);
        }
        ++sum;
      },
      _num_selected);
}

} // namespace brickwall::contact
