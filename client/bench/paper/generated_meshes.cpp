#include "client/bench/paper/generated_meshes.h"

#include <absl/strings/str_format.h>

#include <cmath>
#include <numbers>

namespace curvecast::cli::bench {

std::string square_obj() { return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"; }

std::string sphere_off() {
  constexpr int kRows = 64, kColumns = 128;
  std::string text = absl::StrFormat("OFF\n%d %d 0\n0 1 0\n0 -1 0\n", (kRows - 1) * kColumns + 2, kRows * kColumns);
  for (int row = 1; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double t = std::numbers::pi * row / kRows, p = 2 * std::numbers::pi * column / kColumns;
      absl::StrAppendFormat(&text, "%.9f %.9f %.9f\n", std::sin(t) * std::cos(p), std::cos(t), std::sin(t) * std::sin(p));
    }
  }
  const auto vertex = [](int row, int column) { return 2 + (row - 1) * kColumns + column % kColumns; };
  for (int c = 0; c < kColumns; ++c) {
    absl::StrAppendFormat(&text, "3 0 %d %d\n", vertex(1, c + 1), vertex(1, c));
    absl::StrAppendFormat(&text, "3 1 %d %d\n", vertex(kRows - 1, c), vertex(kRows - 1, c + 1));
    for (int row = 1; row + 1 < kRows; ++row) {
      absl::StrAppendFormat(&text, "4 %d %d %d %d\n", vertex(row, c), vertex(row, c + 1), vertex(row + 1, c + 1),
                            vertex(row + 1, c));
    }
  }
  return text;
}

}  // namespace curvecast::cli::bench
