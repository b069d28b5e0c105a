#include "core/render/stroke_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace curvecast {
namespace {

constexpr double kCapHeight = 21;  // of the glyphs' own units
constexpr double kAdvance = 19;

struct Dot {
  signed char x, y;
};
constexpr Dot kLift = {-1, -1};  // the pen goes up

const std::array<std::vector<Dot>, 11>& glyphs() {  // 0 .. 9 and '/'
  static const std::array<std::vector<Dot>, 11> kGlyphs = {{
      {{9, 21},
       {6, 20},
       {4, 17},
       {3, 12},
       {3, 9},
       {4, 4},
       {6, 1},
       {9, 0},
       {11, 0},
       {14, 1},
       {16, 4},
       {17, 9},
       {17, 12},
       {16, 17},
       {14, 20},
       {11, 21},
       {9, 21}},
      {{6, 17}, {8, 18}, {11, 21}, {11, 0}},
      {{4, 16},
       {4, 17},
       {5, 19},
       {6, 20},
       {8, 21},
       {12, 21},
       {14, 20},
       {15, 19},
       {16, 17},
       {16, 15},
       {15, 13},
       {13, 10},
       {3, 0},
       {17, 0}},
      {{5, 21},
       {16, 21},
       {10, 13},
       {13, 13},
       {15, 12},
       {16, 11},
       {17, 8},
       {17, 6},
       {16, 3},
       {14, 1},
       {11, 0},
       {8, 0},
       {5, 1},
       {4, 2},
       {3, 4}},
      {{13, 21}, {3, 7}, {18, 7}, kLift, {13, 21}, {13, 0}},
      {{15, 21},
       {5, 21},
       {4, 12},
       {5, 13},
       {8, 14},
       {11, 14},
       {14, 13},
       {16, 11},
       {17, 8},
       {17, 6},
       {16, 3},
       {14, 1},
       {11, 0},
       {8, 0},
       {5, 1},
       {4, 2},
       {3, 4}},
      {{16, 18}, {15, 20}, {12, 21}, {10, 21}, {7, 20},  {5, 17},  {4, 12},  {4, 7},   {5, 3},  {7, 1},  {10, 0}, {11, 0},
       {14, 1},  {16, 3},  {17, 6},  {17, 7},  {16, 10}, {14, 12}, {11, 13}, {10, 13}, {7, 12}, {5, 10}, {4, 7}},
      {{17, 21}, {7, 0}, kLift, {3, 21}, {17, 21}},
      {{8, 21}, {5, 20}, {4, 18},  {4, 16},  {5, 14},  {7, 13},  {11, 12}, {14, 11}, {16, 9}, {17, 7},
       {17, 4}, {16, 2}, {15, 1},  {12, 0},  {8, 0},   {5, 1},   {4, 2},   {3, 4},   {3, 7},  {4, 9},
       {6, 11}, {9, 12}, {13, 13}, {15, 14}, {16, 16}, {16, 18}, {15, 20}, {12, 21}, {8, 21}},
      {{16, 14}, {15, 11}, {13, 9},  {10, 8},  {9, 8},  {6, 9},  {4, 11}, {3, 14}, {3, 15}, {4, 18}, {6, 20}, {9, 21},
       {10, 21}, {13, 20}, {15, 18}, {16, 14}, {16, 9}, {15, 4}, {13, 1}, {10, 0}, {8, 0},  {5, 1},  {4, 3}},
      {{17, 23}, {3, -3}},
  }};
  return kGlyphs;
}

}  // namespace

void draw_line(Image& image, const Vec2d& from, const Vec2d& to, double width, const Rgb8& color, double opacity) {
  const double reach = 0.5 * width + 1;
  const Vec2d along = to - from;
  const double square = along.squaredNorm();
  const auto first = [](double x) { return std::max(0, static_cast<int>(std::floor(x))); };
  const int left = first(std::min(from.x(), to.x()) - reach), top = first(std::min(from.y(), to.y()) - reach);
  const int right = std::min(image.width - 1, static_cast<int>(std::max(from.x(), to.x()) + reach));
  const int bottom = std::min(image.height - 1, static_cast<int>(std::max(from.y(), to.y()) + reach));
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const Vec2d p(x + 0.5, y + 0.5);
      const double t = square > 0 ? std::clamp((p - from).dot(along) / square, 0.0, 1.0) : 0;
      const double distance = (p - (from + t * along)).norm();
      const double alpha = opacity * std::clamp(0.5 * width + 0.5 - distance, 0.0, 1.0);
      std::uint8_t* pixel = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + alpha * (color[c] - pixel[c])));
    }
  }
}

void draw_text(Image& image, std::string_view text, const Vec2d& at, double height, const Rgb8& color) {
  const double scale = height / kCapHeight;
  double x = at.x() - 0.5 * scale * kAdvance * static_cast<double>(text.size());
  for (const char c : text) {
    const int glyph = c == '/' ? 10 : c - '0';
    if (glyph >= 0 && glyph <= 10) {
      const std::vector<Dot>& dots = glyphs()[static_cast<std::size_t>(glyph)];
      const auto place = [&](const Dot& dot) { return Vec2d(x + scale * dot.x, at.y() - scale * dot.y); };
      const auto lifts = [](const Dot& dot) { return dot.x == kLift.x && dot.y == kLift.y; };
      for (std::size_t i = 0; i + 1 < dots.size(); ++i) {
        if (!lifts(dots[i]) && !lifts(dots[i + 1])) draw_line(image, place(dots[i]), place(dots[i + 1]), 0.11 * height, color);
      }
    }
    x += scale * kAdvance;
  }
}

}  // namespace curvecast
