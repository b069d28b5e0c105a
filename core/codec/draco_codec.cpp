#include "core/codec/draco_codec.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud_builder.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/sample/radius_ladder.h"

namespace curvecast {
namespace {

absl::Status check(std::size_t count, const DracoOptions& options) {
  if (count == 0) return absl::InvalidArgumentError("there are no points to encode");
  if (options.position_bits < 1 || options.position_bits > 30) {
    return absl::InvalidArgumentError(absl::StrFormat("position_bits = %d; it must lie in 1 .. 30", options.position_bits));
  }
  if (options.normal_bits < 2 || options.normal_bits > 30) {
    return absl::InvalidArgumentError(absl::StrFormat("normal_bits = %d; it must lie in 2 .. 30", options.normal_bits));
  }
  const auto size = static_cast<float>(options.box_size);
  if (!options.box_min.cast<float>().allFinite() || !(size > 0) || !std::isfinite(size)) {
    return absl::InvalidArgumentError("the lattice's box must be finite and larger than nothing, as floats");
  }
  return absl::OkStatus();
}

/// Positions for Draco, which does not survive places outside of its lattice: rounding is put right, all else refused.
absl::StatusOr<std::vector<Vec3f>> within_box(std::span<const Vec3f> positions, const DracoOptions& options) {
  const auto size = static_cast<float>(options.box_size);
  const Vec3f low = options.box_min.cast<float>();
  const Vec3f high = low + Vec3f::Constant(size);
  const Vec3f slack = Vec3f::Constant(1e-3f * size);
  std::vector<Vec3f> inside;
  inside.reserve(positions.size());
  for (const Vec3f& p : positions) {
    if (!((p - low + slack).minCoeff() >= 0 && (high + slack - p).minCoeff() >= 0)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("point %d (%g, %g, %g) lies outside of the lattice's box", inside.size(), p.x(), p.y(), p.z()));
    }
    inside.push_back(p.cwiseMax(low).cwiseMin(high));
  }
  return inside;
}

// A rung is four codes of 255 for 2^(255 / 8).
constexpr int kHighestCode = 255, kCodesPerRung = 4, kCodesPerOctave = kCodesPerRung * RadiusLadder::kRungsPerOctave;

std::vector<std::uint8_t> radius_codes(std::span<const float> radii, float largest) {
  const RadiusLadder ladder(largest);
  std::vector<std::uint8_t> codes(radii.size());
  std::transform(radii.begin(), radii.end(), codes.begin(),
                 [&](float radius) { return static_cast<std::uint8_t>(kHighestCode - kCodesPerRung * ladder.rung(radius)); });
  return codes;
}

std::vector<std::array<std::uint8_t, 3>> without_alpha(std::span<const Rgba8> colours) {
  std::vector<std::array<std::uint8_t, 3>> rgb;
  rgb.reserve(colours.size());
  for (const Rgba8& c : colours) rgb.push_back({c.r, c.g, c.b});
  return rgb;
}

}  // namespace

absl::StatusOr<std::string> encode_draco(const PointSet& points, const DracoOptions& options, float* radius_min,
                                         float* radius_max) {
  return encode_draco(points, 0, points.size(), options, radius_min, radius_max);
}

absl::StatusOr<std::string> encode_draco(const PointSet& points, std::size_t begin, std::size_t count,
                                         const DracoOptions& options, float* radius_min, float* radius_max) {
  if (absl::Status status = check(count, options); !status.ok()) return status;
  const auto part = [&](const auto& column) { return std::span(column).subspan(begin, count); };
  const absl::StatusOr<std::vector<Vec3f>> positions = within_box(part(points.positions), options);
  if (!positions.ok()) return positions.status();
  const std::span<const float> radii = part(points.radii);
  *radius_max = options.radius_max > 0 ? static_cast<float>(options.radius_max) : *std::max_element(radii.begin(), radii.end());
  *radius_min = *radius_max * std::exp2(-static_cast<float>(kHighestCode) / kCodesPerOctave);
  const std::vector<std::uint8_t> codes = radius_codes(radii, *radius_max);
  try {
    draco::PointCloudBuilder builder;
    builder.Start(static_cast<draco::PointIndex::ValueType>(count));
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
    const int radius = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT8);
    builder.SetAttributeValuesForAllPoints(position, positions->data(), sizeof(Vec3f));
    builder.SetAttributeValuesForAllPoints(normal, part(points.normals).data(), sizeof(Vec3f));
    builder.SetAttributeValuesForAllPoints(radius, codes.data(), sizeof(std::uint8_t));
    if (!points.colours.empty()) {
      const int colour = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
      builder.SetAttributeValuesForAllPoints(colour, without_alpha(part(points.colours)).data(), 3);
    }
    const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(/*deduplicate_points=*/false);
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
    const Vec3f corner = options.box_min.cast<float>();
    encoder.SetAttributeExplicitQuantization(draco::GeometryAttribute::POSITION, options.position_bits, 3, corner.data(),
                                             static_cast<float>(options.box_size));
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, options.normal_bits);
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodePointCloudToBuffer(*cloud, &buffer);
    if (!status.ok()) return absl::InternalError(absl::StrCat("Draco could not encode the points: ", status.error_msg_string()));
    return std::string(buffer.data(), buffer.size());
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("Draco could not encode the points: ", error.what()));
  }
}

}  // namespace curvecast
