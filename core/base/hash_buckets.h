// Brings things together that may be the same, without sorting all of them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/for_all.h"

namespace curvecast {

/// Divides the things [0, n) into buckets of some thousands by their hashes, hash(i) of 64 bits, and calls visit(bucket) for each
/// with its things, ascending; several at once. Things of the same hash come in the same bucket. 4 bytes for each thing. Leaves
/// out buckets once the context is cancelled. Precondition: n < 2^32.
template <typename Hash, typename Visit>
void for_each_bucket(const ExecutionContext& context, std::size_t n, const Hash& hash, const Visit& visit) {
  constexpr std::size_t kThings = 1 << 14;  // in a bucket, at most on average
  constexpr std::size_t kBlock = 1 << 18;   // things that a thread takes at once
  const int bits = std::bit_width(n / kThings);
  const auto bucket_of = [&](std::size_t i) { return bits == 0 ? std::uint64_t{0} : hash(i) >> (64 - bits); };
  // First counted, then written: what block b has of a bucket begins where that of the blocks before it ends.
  std::vector<std::vector<std::uint32_t>> place((n + kBlock - 1) / kBlock, std::vector<std::uint32_t>(std::size_t{1} << bits));
  for_blocks(context, n, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++place[begin / kBlock][bucket_of(i)];
  });
  if (context.cancelled()) return;
  std::vector<std::uint32_t> bucket_begin(1, 0);
  for (std::size_t bucket = 0; bucket < std::size_t{1} << bits; ++bucket) {
    std::uint32_t at = bucket_begin.back();
    for (std::vector<std::uint32_t>& of_block : place) at += std::exchange(of_block[bucket], at);
    bucket_begin.push_back(at);
  }
  std::vector<std::uint32_t> things(n);
  for_blocks(context, n, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) things[place[begin / kBlock][bucket_of(i)]++] = static_cast<std::uint32_t>(i);
  });
  for_blocks(context, bucket_begin.size() - 1, 1, [&](std::size_t bucket, std::size_t /*end*/) {
    visit(std::span<const std::uint32_t>(things).subspan(bucket_begin[bucket], bucket_begin[bucket + 1] - bucket_begin[bucket]));
  });
}

}  // namespace curvecast
