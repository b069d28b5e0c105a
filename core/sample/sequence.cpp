#include "core/sample/sequence.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/sample/random.h"
#include "core/sample/reversed_bits.h"

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

}  // namespace

void fill_sequence(Sequence sequence, std::uint64_t seed, std::span<double> q) {
  if (q.empty()) return;
  if (sequence == Sequence::kVanDerCorput || sequence == Sequence::kGoldenRatio) {
    sequence == Sequence::kVanDerCorput ? fill_van_der_corput(q) : fill_golden_ratio(q);
    shift_round(q, random_unit(seed, 0));
    return;
  }
  const double n = static_cast<double>(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) {
    const double within = sequence == Sequence::kJittered ? random_unit(seed, i) : 0.5;
    q[i] = std::min((static_cast<double>(i) + within) / n, kBelowOne);
  }
}

}  // namespace curvecast
