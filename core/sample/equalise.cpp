#include "core/sample/equalise.h"

#include <cmath>

namespace curvecast {

void equalise(const ViewMass& mass, const BlockMass& fixed, std::span<const double> q, std::span<std::uint32_t> vertices) {
  if (!(mass.total > 0) || !std::isfinite(mass.total)) return;
  constexpr float kBelowOne = 0x1.fffffep-1f;
  std::size_t i = 0, last = 0;  // block with mass
  double before = 0;
  const auto place = [&](std::size_t b, float part) {
    vertices[i++] = static_cast<std::uint32_t>(b * kBlockSize + mass.codes_of(fixed, b).vertex(part));
  };
  for (std::size_t b = 0; b < mass.sum.size() && i < q.size(); ++b) {
    if (!(mass.sum[b] > 0)) continue;
    last = b;
    const double sum = static_cast<double>(mass.sum[b]), after = before + sum;
    for (; i < q.size() && q[i] * mass.total < after;) {
      const auto part = static_cast<float>((q[i] * mass.total - before) / sum);
      place(b, part < kBelowOne ? part : kBelowOne);
    }
    before = after;
  }
  while (i < q.size()) place(last, kBelowOne);  // by rounding
}

}  // namespace curvecast
