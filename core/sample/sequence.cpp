#include "core/sample/sequence.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/random.h"
#include "core/base/reversed_bits.h"
#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr double kBelowOne = 1 - 0x1p-53;

/// The first numbers of the sequence, ascending: those multiples of the finest step whose mirror image is one of the first.
void fill_van_der_corput(std::span<double> q) {
  const int bits = std::bit_width(q.size() - 1);
  const double step = std::ldexp(1.0, -bits);
  std::size_t i = 0;
  for (std::uint32_t j = 0; i < q.size(); ++j) {
    q[i] = j * step;
    i += reversed_bits(j, bits) < q.size() ? 1 : 0;
  }
}

/// The first multiples of the golden ratio modulo 1, ascending: each is found from the one before by one of three steps.
void fill_golden_ratio(std::span<double> q) {
  constexpr double kRatio = 0.61803398874989484820;
  const auto place = [](std::uint64_t i) {
    const double turns = static_cast<double>(i) * kRatio;
    return turns - std::floor(turns);
  };
  // The multiples nearest to 0 from above and from below are Fibonacci numbers.
  const std::uint64_t n = q.size();
  std::uint64_t above = 1, below = 1, smaller = 1, larger = 2;
  double least = 1, most = 0;
  for (; smaller < n; std::tie(smaller, larger) = std::pair(larger, smaller + larger)) {
    if (place(smaller) < least) least = place(above = smaller);
    if (place(smaller) > most) most = place(below = smaller);
  }
  std::uint64_t i = 0;
  for (double& to : q) {
    to = place(i);
    i = i + above < n ? i + above : i < below ? i + above - below : i - below;
  }
}

/// Moves ascending numbers by `shift` (in [0, 1)), wraps them round, and brings them into order again.
void shift_round(std::span<double> q, double shift) {
  const auto first = std::lower_bound(q.begin(), q.end(), 1 - shift);
  const std::ptrdiff_t wrapped = q.end() - first;
  std::rotate(q.begin(), first, q.end());
  for (std::ptrdiff_t i = 0; i < wrapped; ++i) q[i] = std::max(q[i] + shift - 1, 0.0);
  for (auto i = static_cast<std::size_t>(wrapped); i < q.size(); ++i) q[i] = std::min(q[i] + shift, kBelowOne);
}

using WordLanes = std::uint64_t __attribute__((vector_size(32)));

/// mix_bits of each.
[[gnu::always_inline]] inline void mix_lanes(WordLanes& z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
}

/// Words below 2^53 as numbers: their halves become digits of doubles, which every processor has instructions for.
[[gnu::always_inline]] inline void to_numbers(const WordLanes& words, Double4& to) {
  constexpr double kLower = 0x1p52, kUpper = 0x1p84;
  const WordLanes lower = (words & 0xffffffffu) | std::bit_cast<std::uint64_t>(kLower);
  const WordLanes upper = words >> 32 | std::bit_cast<std::uint64_t>(kUpper);
  Double4 low, high;
  load_lanes(low, &lower);
  load_lanes(high, &upper);
  to = (high - (kUpper + kLower)) + low;
}

/// (i + random_unit(seed, i)) / N, but for the last few, which do not fill the lanes. Returns how many it wrote.
CURVECAST_WIDE std::size_t fill_jittered_lanes(std::uint64_t seed, std::span<double> q) {
  const double n = static_cast<double>(q.size());
  const std::uint64_t start = random_start(seed);
  WordLanes counter = {start, start + kRandomStep, start + 2 * kRandomStep, start + 3 * kRandomStep};
  Double4 place = {0, 1, 2, 3};
  std::size_t i = 0;
  for (; i + 4 <= q.size(); i += 4) {
    WordLanes bits = counter;
    mix_lanes(bits);
    Double4 within;
    to_numbers(bits >> 11, within);
    Double4 to = (place + within * 0x1p-53) / n;
    to = to < kBelowOne ? to : Double4{} + kBelowOne;
    store_lanes(to, &q[i]);
    counter += 4 * kRandomStep;
    place += 4.0;
  }
  return i;
}

}  // namespace

void fill_sequence(Sequence sequence, std::uint64_t seed, std::span<double> q) {
  if (q.empty()) return;
  if (sequence == Sequence::kVanDerCorput || sequence == Sequence::kGoldenRatio) {
    sequence == Sequence::kVanDerCorput ? fill_van_der_corput(q) : fill_golden_ratio(q);
    shift_round(q, random_unit(seed, 0));
    return;
  }
  const double n = static_cast<double>(q.size());
  const std::size_t done = sequence == Sequence::kJittered ? fill_jittered_lanes(seed, q) : 0;
  for (std::size_t i = done; i < q.size(); ++i) {
    const double within = sequence == Sequence::kJittered ? random_unit(seed, i) : 0.5;
    q[i] = std::min((static_cast<double>(i) + within) / n, kBelowOne);
  }
}

}  // namespace curvecast
