#include "tests/support/draco_reference.h"

#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud_builder.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "core/sample/radius_ladder.h"

namespace curvecast::testing {

std::string draco_reference(const PointSet& points, const DracoOptions& options) {
  const double largest =
      options.radius_max > 0 ? options.radius_max : *std::max_element(points.radii.begin(), points.radii.end());
  const RadiusLadder ladder(static_cast<float>(largest));
  std::vector<std::uint8_t> codes;
  for (const float radius : points.radii) codes.push_back(static_cast<std::uint8_t>(255 - 4 * ladder.rung(radius)));
  std::vector<std::array<std::uint8_t, 3>> rgb;
  for (const Rgba8& c : points.colours) rgb.push_back({c.r, c.g, c.b});

  draco::PointCloudBuilder builder;
  builder.Start(static_cast<draco::PointIndex::ValueType>(points.size()));
  const auto add = [&](draco::GeometryAttribute::Type type, std::int8_t components, draco::DataType data_type,
                       const void* values) {
    builder.SetAttributeValuesForAllPoints(builder.AddAttribute(type, components, data_type), values, 0);
  };
  add(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, points.positions.data());
  add(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32, points.normals.data());
  add(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT8, codes.data());
  if (!rgb.empty()) add(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8, rgb.data());
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(/*deduplicate_points=*/false);

  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  const Vec3f corner = options.box_min.cast<float>();
  encoder.SetAttributeExplicitQuantization(draco::GeometryAttribute::POSITION, options.position_bits, 3, corner.data(),
                                           static_cast<float>(options.box_size));
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, options.normal_bits);
  draco::EncoderBuffer buffer;
  if (const draco::Status status = encoder.EncodePointCloudToBuffer(*cloud, &buffer); !status.ok()) {
    throw std::runtime_error(status.error_msg_string());
  }
  return {buffer.data(), buffer.size()};
}

}  // namespace curvecast::testing
