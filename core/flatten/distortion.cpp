#include "core/flatten/distortion.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "core/flatten/orientation.h"

namespace curvecast {
namespace {

// Bins of ratios: so many for each factor of two, for so many of these above 1, and as many below.
constexpr int kBinsPerOctave = 1024, kOctaves = 32;
constexpr std::size_t kHalf = std::size_t{kBinsPerOctave} * kOctaves;

std::size_t bin_of(double octaves) {
  const double place = std::floor(octaves * kBinsPerOctave) + static_cast<double>(kHalf);
  return static_cast<std::size_t>(std::clamp(place, 0.0, 2.0 * kHalf - 1));
}

}  // namespace

std::uint64_t count_flipped(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  std::uint64_t flipped = 0;
  for (const Triangle& t : disc.triangles) flipped += orientation(uv[t[0]], uv[t[1]], uv[t[2]]) <= 0;
  return flipped;
}

double uv_area(const ChartView& chart, std::size_t t) {
  const Triangle& v = chart.triangles[t];
  const Vec2d p = chart.uv[v[1]] - chart.uv[v[0]];
  const Vec2d q = chart.uv[v[2]] - chart.uv[v[0]];
  return 0.5 * (p.x() * q.y() - p.y() * q.x());
}

double area_ratio(const ChartView& chart, std::size_t t) { return triangle_area(chart, t) / uv_area(chart, t); }

Stretch measure_stretch(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  constexpr double kSmallestArea = 1e-60;  // in uv: stands for triangles that rounding has collapsed or folded
  Stretch stretch;
  stretch.vertex.assign(disc.vertex_count(), 0.0);
  std::vector<double> area_sum(disc.vertex_count(), 0.0);
  double surface = 0;
  for (const Triangle& t : disc.triangles) {
    const Vec2d p = uv[t[1]] - uv[t[0]];
    const Vec2d q = uv[t[2]] - uv[t[0]];
    const Vec3d e = disc.positions[t[1]] - disc.positions[t[0]];
    const Vec3d f = disc.positions[t[2]] - disc.positions[t[0]];
    const double area = 0.5 * e.cross(f).norm();
    const double determinant = std::max(p.x() * q.y() - p.y() * q.x(), kSmallestArea);
    const Vec3d along_u = (e * q.y() - f * p.y()) / determinant;
    const Vec3d along_v = (f * p.x() - e * q.x()) / determinant;
    const double square = 0.5 * (along_u.squaredNorm() + along_v.squaredNorm());
    for (const std::uint32_t v : t) {
      stretch.vertex[v] += area * square;
      area_sum[v] += area;
    }
    stretch.total += area * square;
    surface += area;
  }
  stretch.total = std::sqrt(stretch.total) / surface;  // the square's own area is 1
  for (std::size_t v = 0; v < area_sum.size(); ++v) stretch.vertex[v] = std::sqrt(stretch.vertex[v] / (area_sum[v] * surface));
  return stretch;
}

void DistortionSummary::add(const AreaShare& share) {
  if (bins_.empty()) bins_.resize(2 * kHalf);
  const double octaves = std::log2(share.ratio);
  const double levels = std::max(0.0, 0.5 * octaves);
  extra_levels_ += share.area * levels;
  most_extra_levels_ = std::max(most_extra_levels_, levels);
  area_ += share.area;
  largest_ = std::max({largest_, share.ratio, 1 / share.ratio});
  Bin& bin = bins_[bin_of(octaves)];
  bin.area += share.area;
  bin.farthest = octaves < 0 ? std::min(bin.farthest, share.ratio) : std::max(bin.farthest, share.ratio);
}

void DistortionSummary::add(const DistortionSummary& other) {
  if (bins_.empty()) bins_.resize(2 * kHalf);
  for (std::size_t i = 0; i < other.bins_.size(); ++i) {
    const Bin& from = other.bins_[i];
    bins_[i].area += from.area;
    bins_[i].farthest = i < kHalf ? std::min(bins_[i].farthest, from.farthest) : std::max(bins_[i].farthest, from.farthest);
  }
  area_ += other.area_;
  extra_levels_ += other.extra_levels_;
  most_extra_levels_ = std::max(most_extra_levels_, other.most_extra_levels_);
  largest_ = std::max(largest_, other.largest_);
}

/// Of the ratios themselves.
double DistortionSummary::quantile(double part) const {
  double sum = 0;
  for (const Bin& bin : bins_) {
    sum += bin.area;
    if (sum > part * area_) return bin.farthest;
  }
  return largest_;
}

/// Of max(ratio, 1 / ratio): by bins in pairs, as far above 1 as below it.
double DistortionSummary::folded_quantile(double part) const {
  double sum = 0;
  for (std::size_t i = 0; i < kHalf; ++i) {
    const Bin &below = bins_[kHalf - 1 - i], &above = bins_[kHalf + i];
    sum += below.area + above.area;
    if (sum > part * area_) return std::max(above.farthest, 1 / below.farthest);
  }
  return largest_;
}

Distortion DistortionSummary::distortion() const {
  return {.p50 = folded_quantile(0.5),
          .p99 = folded_quantile(0.99),
          .p999 = folded_quantile(0.999),
          .max = largest_,
          .density_p999 = quantile(0.999),
          .extra_levels_mean = extra_levels_ / area_,
          .extra_levels_max = most_extra_levels_};
}

Distortion measure_distortion(std::span<const Chart> charts, const ExecutionContext& context) {
  // A summary is a megabyte, and summing two takes as long as adding thousands of triangles: so there are few, whatever the
  // number of threads, and one for a small mesh.
  constexpr std::size_t kMostSummaries = 64, kLeastFaces = 16'384;
  std::size_t faces = 0;
  for (const Chart& chart : charts) faces += chart.disc.face_count();
  const std::size_t summaries = std::clamp<std::size_t>(faces / kLeastFaces, 1, kMostSummaries);
  const std::size_t grain = charts.size() / summaries + 1;
  return tbb::parallel_deterministic_reduce(
             tbb::blocked_range<std::size_t>(0, charts.size(), grain), DistortionSummary{},
             [&](const tbb::blocked_range<std::size_t>& range, DistortionSummary summary) {
               for (std::size_t c = range.begin(); c < range.end() && !context.cancelled(); ++c) {
                 const auto& [disc, uv, parameterisation] = charts[c];
                 const double mean = surface_area(disc);  // the square's area is 1
                 for (std::size_t t = 0; t < disc.face_count(); ++t) {
                   summary.add({triangle_area(disc, t), area_ratio({disc, uv}, t) / mean});
                 }
               }
               return summary;
             },
             [](DistortionSummary a, const DistortionSummary& b) {
               a.add(b);
               return a;
             })
      .distortion();
}

}  // namespace curvecast
