#include "tests/client/draco/draco_clouds.h"

#include <draco/compression/encode.h>
#include <draco/compression/expert_encode.h>
#include <draco/point_cloud/point_cloud_builder.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tests/client/sphere_points.h"

namespace curvecast::client {
namespace {

using Attribute = draco::GeometryAttribute;

std::string bytes_of(draco::ExpertEncoder& encoder) {
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeToBuffer(&buffer).ok()) throw std::runtime_error("Draco cannot encode the test's points");
  return {buffer.data(), buffer.size()};
}

template <typename T>
int add(draco::PointCloudBuilder& builder, Attribute::Type type, int components, draco::DataType data, const T& values) {
  const int id = builder.AddAttribute(type, static_cast<std::int8_t>(components), data);
  builder.SetAttributeValuesForAllPoints(id, values.data(), 0);
  return id;
}

/// Where a point of [-1, 1]^3 lies along a Z curve.
std::uint32_t place_on_curve(const std::array<float, 3>& p) {
  std::uint32_t place = 0;
  for (int bit = 9; bit >= 0; --bit) {
    for (const float x : p) place = place << 1 | (static_cast<std::uint32_t>(511.5F * (x + 1)) >> bit & 1);
  }
  return place;
}

}  // namespace

std::string draco_cloud(const DracoCloudOptions& options) {
  const std::size_t n = options.points;
  Points points = sphere_points(n);
  std::mt19937 random(static_cast<unsigned>(n));
  std::sort(points.positions.begin(), points.positions.end(),
            [](const auto& a, const auto& b) { return place_on_curve(a) < place_on_curve(b); });
  points.normals = points.positions;
  if (options.scattered) {
    for (std::size_t i = n - 1; i > 0; --i) {
      const std::size_t other = random() % (i + 1);
      std::swap(points.positions[i], points.positions[other]);
      std::swap(points.normals[i], points.normals[random() % (i + 1)]);
    }
  }
  std::vector<std::uint8_t> radii(n), colours(n * static_cast<std::size_t>(options.colour_components));
  for (std::uint8_t& code : radii) code = static_cast<std::uint8_t>(200 + random() % 3 * 4);
  for (std::uint8_t& channel : colours) channel = static_cast<std::uint8_t>(random() % 256);
  if (options.all_equal) {
    points.positions.assign(n, {1, 2, 3});
    points.normals.assign(n, {0, 0, -1});
    radii.assign(n, 7);
    std::fill(colours.begin(), colours.end(), 9);
  }
  draco::PointCloudBuilder builder;
  builder.Start(static_cast<std::uint32_t>(n));
  const int position = add(builder, Attribute::POSITION, 3, draco::DT_FLOAT32, points.positions);
  const int normal = add(builder, Attribute::NORMAL, 3, draco::DT_FLOAT32, points.normals);
  add(builder, Attribute::GENERIC, 1, draco::DT_UINT8, radii);
  if (!colours.empty()) add(builder, Attribute::COLOR, options.colour_components, draco::DT_UINT8, colours);
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
  draco::ExpertEncoder encoder(*cloud);
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(options.speed, options.speed);
  encoder.SetAttributeQuantization(position, options.position_bits);
  encoder.SetAttributeQuantization(normal, options.normal_bits);
  encoder.SetUseBuiltInAttributeCompression(options.entropy_coded);
  return bytes_of(encoder);
}

std::string other_draco_cloud(OtherCloud kind) {
  const Points points = sphere_points(500);
  const std::vector<std::uint8_t> radii(500, 3);
  draco::PointCloudBuilder builder;
  builder.Start(500);
  const int position = add(builder, Attribute::POSITION, 3, draco::DT_FLOAT32, points.positions);
  add(builder, Attribute::GENERIC, 1, draco::DT_UINT8, radii);
  if (kind == OtherCloud::kTextured) add(builder, Attribute::TEX_COORD, 3, draco::DT_FLOAT32, points.normals);
  if (kind == OtherCloud::kTwoRadii) add(builder, Attribute::GENERIC, 1, draco::DT_UINT8, radii);
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
  draco::ExpertEncoder encoder(*cloud);
  const bool tree = kind == OtherCloud::kTree;
  encoder.SetEncodingMethod(tree ? draco::POINT_CLOUD_KD_TREE_ENCODING : draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  if (kind != OtherCloud::kFloats) encoder.SetAttributeQuantization(position, 12);
  if (kind == OtherCloud::kUnpredicted && !encoder.SetAttributePredictionScheme(position, draco::PREDICTION_NONE).ok()) {
    throw std::runtime_error("Draco always predicts");
  }
  return bytes_of(encoder);
}

}  // namespace curvecast::client
