// Draco point clouds to test with, from Draco's own encoder.
#pragma once

#include <cstddef>
#include <string>

namespace curvecast::client {

struct DracoCloudOptions {
  std::size_t points = 1000;
  int position_bits = 11, normal_bits = 8;
  int colour_components = 0;  // 0, 3 or 4
  int speed = 5;              // 0 .. 10, as Draco counts
  bool entropy_coded = true;
  bool all_equal = false;
  bool scattered = false;  // or else in order along a curve, which keeps differences small
};

/// Positions, normals, a byte per point and colours.
std::string draco_cloud(const DracoCloudOptions& options);

/// Clouds of Draco's that are not ours: by a kd-tree, of plain floats, with texture coordinates, with two radii, without
/// prediction.
enum class OtherCloud { kTree, kFloats, kTextured, kTwoRadii, kUnpredicted };
std::string other_draco_cloud(OtherCloud kind);

}  // namespace curvecast::client
