#include "server/convert/convert_measure.h"

#include <absl/strings/str_cat.h>

#include <array>
#include <bit>
#include <cstring>

#include "core/sample/point_set.h"
#include "server/base/protocol.h"
#include "server/convert/convert.h"
#include "server/convert/convert_density.h"
#include "server/convert/field_validator.h"

namespace curvecast::server {
namespace {

using Floats = std::array<float, 3>;

constexpr std::uint64_t kLeastDistanceSamples = 1'000, kMostDistanceSamples = 100'000'000;

v1::Discrepancy to_proto(const Discrepancy& in) {
  v1::Discrepancy out;
  out.set_max(in.max);
  out.set_rms(in.rms);
  out.set_rms_relative(in.rms_relative);
  return out;
}

}  // namespace

absl::StatusOr<MeasureOptions> to_measure_options(const v1::MeasureRequest& request) {
  FieldValidator check;
  MeasureOptions options;
  const auto count = [&](const char* field, std::uint32_t value, int* option) {
    if (value != 0) *option = static_cast<int>(check.in_range(field, value, 1u, std::uint32_t{kMaxRegions}));
  };
  count("ring_seeds", request.ring_seeds(), &options.ring_seeds);
  count("ball_centres", request.ball_centres(), &options.ball_centres);
  options.seed = request.seed();
  check_viewport(check, "viewport", request.has_viewport() ? &request.viewport() : nullptr);
  options.density =
      to_density(check, "density", request.density(), to_cameras(check, "cameras", request.cameras(), request.viewport()),
                 "needs a camera, which the request does not have");
  if (!check.ok()) return check.status();
  return options;
}

absl::StatusOr<HausdorffOptions> to_hausdorff_options(const v1::MeasureRequest& request) {
  FieldValidator check;
  HausdorffOptions options;
  if (const std::uint64_t samples = request.distance_samples(); samples != 0) {
    options.samples = check.in_range("distance_samples", samples, kLeastDistanceSamples, kMostDistanceSamples);
  }
  options.cameras = to_cameras(check, "cameras", request.cameras(), request.viewport());
  if (!check.ok()) return check.status();
  return options;
}

absl::StatusOr<std::vector<std::vector<Vec3d>>> to_point_sets(const v1::MeasureRequest& request,
                                                              const std::vector<std::shared_ptr<const Mesh>>& files) {
  static_assert(std::endian::native == std::endian::little);
  FieldValidator check;
  std::uint64_t all = 0;
  for (std::size_t s = 0; s < files.size(); ++s) {
    const std::uint64_t points = files[s]->size() / sizeof(Floats);
    if (files[s]->size() % sizeof(Floats) != 0) {
      check.fail(absl::StrCat("sets[", s, "].points_id"),
                 absl::StrCat("names ", files[s]->size(), " bytes; points have ", sizeof(Floats), " each"));
    }
    all += points;
    if (points <= kMaxPoints && all <= kMaxMeasuredPoints) continue;
    return absl::OutOfRangeError(absl::StrCat("sets[", s, "] has ", points, " points, ", all, " with those before it; at most ",
                                              kMaxPoints, " are measured in a set, and ", kMaxMeasuredPoints, " at once"));
  }
  std::vector<std::vector<Vec3d>> sets(files.size());
  for (std::size_t s = 0; check.ok() && s < files.size(); ++s) {
    const Vec3d origin = check.vector(absl::StrCat("sets[", s, "].origin"), request.sets(static_cast<int>(s)).origin());
    const std::span<const char> bytes = files[s]->bytes();
    sets[s].reserve(bytes.size() / sizeof(Floats));
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(Floats)) {
      Floats p;
      std::memcpy(&p, bytes.data() + at, sizeof p);
      sets[s].emplace_back(origin + Vec3d(p[0], p[1], p[2]));
    }
  }
  if (!check.ok()) return check.status();
  return sets;
}

v1::MeshDistance to_proto(const HausdorffDistance& distance, double diagonal) {
  const auto one_way = [diagonal](const SurfaceDistance& in, v1::OneWayDistance& out) {
    out.set_max(100 * in.max / diagonal);
    out.set_mean(100 * in.mean / diagonal);
    out.set_rms(100 * in.rms / diagonal);
    *out.mutable_farthest() = to_proto(in.farthest);
    out.set_normal_mean(in.normal_mean);
    out.set_normal_rms(in.normal_rms);
    out.set_picture_max(in.picture_max);
    out.set_picture_mean(in.picture_mean);
    out.set_picture_rms(in.picture_rms);
    out.set_picture_share(in.picture_share);
  };
  v1::MeshDistance out;
  one_way(distance.forward, *out.mutable_from_mesh());
  one_way(distance.backward, *out.mutable_from_other());
  out.set_max(100 * distance.max() / diagonal);
  out.set_diagonal(diagonal);
  return out;
}

v1::Measures to_proto(const MeasureReport& report, double diagonal) {
  v1::Measures out;
  for (const PointMeasures& in : report.sets) {
    v1::PointMeasures& set = *out.add_sets();
    set.set_points(in.points);
    set.mutable_on_surface()->set_max(100 * in.surface_max / diagonal);
    set.mutable_on_surface()->set_mean(100 * in.surface_mean / diagonal);
    *set.mutable_ring_discrepancy() = to_proto(in.ring);
    *set.mutable_ball_discrepancy() = to_proto(in.ball);
    v1::Spacing& spacing = *set.mutable_spacing();
    spacing.set_rho(in.spacing.min);
    spacing.set_nn_mean(in.spacing.mean);
    spacing.set_nn_max(in.spacing.max);
    spacing.set_coverage(in.coverage);
    spacing.set_rho_same_side(in.spacing_on_side.min);
  }
  if (report.gradient) {
    v1::MeasureGradients& gradient = *out.mutable_gradient();
    gradient.set_ring_max(report.gradient->ring_max);
    gradient.set_ring_rms(report.gradient->ring_rms);
    gradient.set_ball_max(report.gradient->ball_max);
    gradient.set_ball_rms(report.gradient->ball_rms);
  }
  return out;
}

}  // namespace curvecast::server
