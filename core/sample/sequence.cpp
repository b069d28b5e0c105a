#include "core/sample/sequence.h"

#include <algorithm>

#include "core/sample/random.h"

namespace curvecast {

void fill_sequence(Sequence sequence, std::uint64_t seed, std::span<double> q) {
  constexpr double kBelowOne = 1 - 0x1p-53;
  const double n = static_cast<double>(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) {
    const double within = sequence == Sequence::kJittered ? random_unit(seed, i) : 0.5;
    q[i] = std::min((static_cast<double>(i) + within) / n, kBelowOne);
  }
}

}  // namespace curvecast
