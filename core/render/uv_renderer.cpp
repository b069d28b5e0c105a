#include "core/render/uv_renderer.h"

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/base/cross.h"
#include "core/render/stroke_text.h"
#include "core/render/tile_grid.h"

namespace curvecast {
namespace {

constexpr std::uint32_t kEmpty = std::numeric_limits<std::uint32_t>::max();

/// Brewer's diverging scale from blue to red.
constexpr std::array<Rgb8, 11> kColours = {{{5, 48, 97},
                                            {33, 102, 172},
                                            {67, 147, 195},
                                            {146, 197, 222},
                                            {209, 229, 240},
                                            {247, 247, 247},
                                            {253, 219, 199},
                                            {244, 165, 130},
                                            {214, 96, 77},
                                            {178, 24, 43},
                                            {103, 0, 31}}};

using Colour = std::array<float, 3>;  // sRGB, 0 .. 255

/// x from -1 to 1.
Colour colour_at(double x) {
  const double place = (std::clamp(x, -1.0, 1.0) + 1) / 2 * (kColours.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kColours.size() - 2);
  const double t = place - static_cast<double>(i);
  Colour colour;
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] = static_cast<float>((1 - t) * kColours[i][c] + t * kColours[i + 1][c]);
  }
  return colour;
}

absl::Status check(std::span<const UvDisc> discs, const UvRenderOptions& options) {
  if (discs.empty()) return absl::InvalidArgumentError("there is no disc to draw");
  const auto is_side = [](int side) { return side >= 64 && side <= 8192; };
  if (!is_side(options.width) || !is_side(options.height) || options.supersample < 1 || options.supersample > 4 ||
      options.max_tiles < 1) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "cannot draw %d x %d pixels with supersample %d and %d tiles: sides must be 64 .. 8192, supersample 1 .. 4, "
        "tiles >= 1",
        options.width, options.height, options.supersample, options.max_tiles));
  }
  for (std::size_t d = 0; d < discs.size(); ++d) {
    const UvDisc& disc = discs[d];
    const bool fits = std::all_of(disc.triangles.begin(), disc.triangles.end(), [&](const Triangle& t) {
      return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < disc.uv.size(); });
    });
    const bool inside = std::all_of(disc.uv.begin(), disc.uv.end(),
                                    [](const Vec2d& p) { return p.minCoeff() >= 0 && p.maxCoeff() <= 1; });  // no NaN either
    if (!fits || !inside || disc.triangles.size() != disc.area_ratios.size()) {
      return absl::InvalidArgumentError(
          absl::StrCat("disc ", d, " has vertices outside of the square or arrays that do not match"));
    }
  }
  return absl::OkStatus();
}

/// A triangle's share of its square and the decimal logarithm of its ratio over the mean.
struct Share {
  double area, log_ratio;
};

struct DiscField {
  const UvDisc* disc;
  double surface = 0;  // area
  std::vector<Share> shares;
};

DiscField measure(const UvDisc& disc) {
  DiscField field{&disc, 0, std::vector<Share>(disc.triangles.size())};
  double square = 0;
  for (std::size_t t = 0; t < field.shares.size(); ++t) {
    const auto& [a, b, c] = disc.triangles[t];
    field.shares[t].area = 0.5 * std::abs(cross(disc.uv[b] - disc.uv[a], disc.uv[c] - disc.uv[a]));
    square += field.shares[t].area;
    field.surface += field.shares[t].area * disc.area_ratios[t];
  }
  const double mean = square > 0 && field.surface > 0 ? field.surface / square : 1;
  for (std::size_t t = 0; t < field.shares.size(); ++t) {
    field.shares[t].log_ratio = std::log10(std::max(disc.area_ratios[t] / mean, 1e-300));
  }
  return field;
}

/// Half the length of the scale, in decades: round, and enough for all but a two-hundredth of the squares.
double choose_decades(const std::vector<DiscField>& fields) {
  std::vector<Share> all;
  for (const DiscField& field : fields) {
    for (const Share& share : field.shares) all.push_back({share.area, std::abs(share.log_ratio)});
  }
  std::sort(all.begin(), all.end(), [](const Share& a, const Share& b) { return a.log_ratio < b.log_ratio; });
  const double total = std::accumulate(all.begin(), all.end(), 0.0, [](double sum, const Share& s) { return sum + s.area; });
  double sum = 0, wanted = 0;
  for (const Share& share : all) {
    if (sum > 0.995 * total) break;
    sum += share.area;
    wanted = share.log_ratio;
  }
  for (const double factor : {2.0, 3.0, 5.0, 10.0, 20.0, 50.0}) {
    if (wanted <= std::log10(factor)) return std::log10(factor);
  }
  return std::clamp(std::ceil(wanted), 2.0, 9.0);
}

/// A square of the picture and the triangles under its samples.
class Tile {
 public:
  Tile(const DiscField& field, int side, int supersample)
      : field_(field), side_(side), supersample_(supersample), samples_(side * supersample) {
    under_.assign(static_cast<std::size_t>(samples_) * samples_, kEmpty);
    for (std::size_t t = 0; t < field_.shares.size(); ++t) fill(static_cast<std::uint32_t>(t));
  }

  void paint(double decades, int left, int top, Image& image) const {
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x)
        paint_pixel(decades, x, y, &image.rgba[4 * (std::size_t(top + y) * image.width + left + x)]);
    }
  }

 private:
  Vec2d place(std::uint32_t v) const {  // in samples, from the upper left
    const Vec2d& p = field_.disc->uv[v];
    return {p.x() * samples_, (1 - p.y()) * samples_};
  }

  void fill(std::uint32_t t) {
    const Triangle& v = field_.disc->triangles[t];
    const Vec2d a = place(v[0]);
    Vec2d b = place(v[1]), c = place(v[2]);
    if (cross(b - a, c - a) < 0) std::swap(b, c);
    const auto clamped = [&](double x) { return std::clamp(static_cast<int>(x), 0, samples_ - 1); };
    const Vec2d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    for (int y = clamped(low.y() - 0.5); y <= clamped(high.y() + 0.5); ++y) {
      for (int x = clamped(low.x() - 0.5); x <= clamped(high.x() + 0.5); ++x) {
        const Vec2d p(x + 0.5, y + 0.5);
        if (cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0) {
          under_[static_cast<std::size_t>(y) * samples_ + x] = t;
        }
      }
    }
  }

  /// How much ink the edges put on a sample of triangle t: more the larger the triangle.
  double ink(std::uint32_t t, const Vec2d& p) const {
    const Triangle& v = field_.disc->triangles[t];
    double nearest = std::numeric_limits<double>::infinity(), longest = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec2d from = place(v[i]), along = place(v[(i + 1) % 3]) - from;
      const double length = along.norm();
      longest = std::max(longest, length);
      if (length > 0) nearest = std::min(nearest, std::abs(cross(along, p - from)) / length);
    }
    const double height = 2 * field_.shares[t].area * samples_ * samples_ / std::max(longest, 1e-300) / supersample_;  // pixels
    const double strength = std::clamp((height - 4) / 12, 0.0, 1.0);
    return nearest < 0.45 * supersample_ ? 0.45 * strength : 0;  // half the width of a line on either side
  }

  void paint_pixel(double decades, int x, int y, std::uint8_t* pixel) const {
    Colour sum{};
    int count = 0;
    for (int sy = y * supersample_; sy < (y + 1) * supersample_; ++sy) {
      for (int sx = x * supersample_; sx < (x + 1) * supersample_; ++sx) {
        const std::uint32_t t = under_[static_cast<std::size_t>(sy) * samples_ + sx];
        if (t == kEmpty) continue;
        const Colour colour = colour_at(field_.shares[t].log_ratio / decades);
        const auto dark = static_cast<float>(ink(t, Vec2d(sx + 0.5, sy + 0.5)));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += (1 - dark) * colour[c] + dark * static_cast<float>(kTileInk[c]);
        ++count;
      }
    }
    if (count == 0) return;
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(std::lround(sum[c] / static_cast<float>(count)));
  }

  const DiscField& field_;
  const int side_, supersample_, samples_;
  std::vector<std::uint32_t> under_;  // triangle of each sample
};

/// The scale below the squares: from 1 / factor to factor.
void draw_legend(double decades, int middle, int top, int length, int height, Image& image) {
  const int left = middle - length / 2, bar = height / 3;
  for (int x = 0; x < length; ++x) {
    const Colour colour = colour_at(2 * (x + 0.5) / length - 1);
    for (int y = top; y < top + bar; ++y) {
      std::uint8_t* pixel = &image.rgba[4 * (std::size_t(y) * image.width + left + x)];
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(std::lround(colour[c]));
    }
  }
  const std::string factor = absl::StrFormat("%.0f", std::pow(10, decades));
  const std::array<std::string, 3> labels = {"1/" + factor, "1", factor};
  for (int i = 0; i < 3; ++i) {
    const double x = left + 0.5 * length * i;
    draw_line(image, {x, top + bar + 1.0}, {x, top + 1.3 * bar}, 1, kTileInk);
    draw_text(image, labels[static_cast<std::size_t>(i)], {x, top + 0.95 * height}, 0.36 * height, kTileInk);
  }
}

}  // namespace

absl::StatusOr<UvPicture> render_uv(std::span<const UvDisc> discs, const UvRenderOptions& options) {
  if (absl::Status status = check(discs, options); !status.ok()) return status;
  std::vector<DiscField> fields;
  for (const UvDisc& disc : discs) fields.push_back(measure(disc));
  std::stable_sort(fields.begin(), fields.end(), [](const DiscField& a, const DiscField& b) { return a.surface > b.surface; });
  if (fields.size() > static_cast<std::size_t>(options.max_tiles)) fields.resize(options.max_tiles);

  const int width = options.width, height = options.height;
  const int legend = std::max(16, std::min(width, height) / 22);
  const auto count = static_cast<int>(fields.size());
  const TileGrid grid = lay_out_tiles(width, height, count, legend);
  if (grid.side < 1) {
    return absl::InvalidArgumentError(absl::StrFormat("%d x %d pixels are too few for %d squares", width, height, count));
  }
  UvPicture picture{blank_image(width, height, options.background), 1, count};
  const double decades = choose_decades(fields);
  picture.scale = std::pow(10, decades);
  for (int i = 0; i < count; ++i) {
    Tile(fields[static_cast<std::size_t>(i)], grid.side, options.supersample).paint(decades, grid.x(i), grid.y(i), picture.image);
    draw_tile_frame(picture.image, grid, i);
  }
  draw_legend(decades, width / 2, grid.bottom() + grid.gap, std::min(width - 6 * grid.gap, std::max(grid.side / 2, width / 3)),
              legend, picture.image);
  return picture;
}

}  // namespace curvecast
