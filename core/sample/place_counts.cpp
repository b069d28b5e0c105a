#include "core/sample/place_counts.h"

#include <algorithm>
#include <bit>

namespace curvecast {
namespace {

constexpr int kLeastBits = 6, kMostBits = 14;  // of buckets: few points in each, and all of their counts stay in the cache

}  // namespace

void PlaceCounts::count_below(std::span<const std::uint32_t> places, std::span<const std::uint32_t> queries,
                              std::span<std::uint32_t> below) {
  if (places.empty()) {
    std::ranges::fill(below, 0);
    return;
  }
  const auto [least, most] = std::ranges::minmax_element(places);
  const std::uint32_t low = *least, high = *most;
  const int bits = std::clamp(static_cast<int>(std::bit_width(places.size())) - 1, kLeastBits, kMostBits);
  const std::size_t buckets = std::size_t{1} << bits;
  const int shift = std::max(static_cast<int>(std::bit_width(high - low)) - bits, 0);
  const auto bucket_of = [low, shift](std::uint32_t place) { return static_cast<std::size_t>((place - low) >> shift); };
  first_.assign(buckets + 1, 0);
  for (const std::uint32_t place : places) ++first_[bucket_of(place) + 1];
  for (std::size_t b = 0; b < buckets; ++b) first_[b + 1] += first_[b];
  wanted_.assign(buckets, 0);
  for (const std::uint32_t query : queries) {
    if (query > low && query <= high) wanted_[bucket_of(query)] = 1;
  }
  end_.resize(buckets);
  std::uint32_t size = 0;
  for (std::size_t b = 0; b < buckets; ++b) {
    end_[b] = size;
    if (wanted_[b] != 0) size += first_[b + 1] - first_[b];
  }
  members_.resize(size);
  for (const std::uint32_t place : places) {
    const std::size_t b = bucket_of(place);
    if (wanted_[b] != 0) members_[end_[b]++] = place;
  }
  const auto members = [&](std::size_t b) {
    const std::size_t count = first_[b + 1] - first_[b];
    return std::span(members_).subspan(end_[b] - count, count);
  };
  for (std::size_t b = 0; b < buckets; ++b) {
    if (wanted_[b] != 0) std::ranges::sort(members(b));
  }
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const std::uint32_t query = queries[i];
    if (query <= low || query > high) {
      below[i] = query <= low ? 0 : static_cast<std::uint32_t>(places.size());
      continue;
    }
    const std::size_t b = bucket_of(query);
    const auto inside = members(b);
    below[i] = first_[b] + static_cast<std::uint32_t>(std::ranges::lower_bound(inside, query) - inside.begin());
  }
}

std::size_t PlaceCounts::byte_size() const {
  return (first_.capacity() + end_.capacity() + members_.capacity()) * sizeof(std::uint32_t) + wanted_.capacity();
}

}  // namespace curvecast
