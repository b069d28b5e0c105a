// What the JSON of a glTF says about the shape and looks of its scenes, as plain structures. Indices are as written, and checked
// where they are used; -1 stands for none.
#pragma once

#include <absl/status/statusor.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace curvecast {

/// The types of numbers in buffers, as the format numbers them.
enum class GltfComponent { kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };

/// A part of a buffer.
struct GltfView {
  std::int64_t buffer = -1;
  std::uint64_t offset = 0, length = 0, stride = 0;  // bytes; stride 0: packed
};

/// Where the elements of an accessor begin.
struct GltfRegion {
  std::int64_t view = -1;
  std::uint64_t offset = 0;  // bytes
  GltfComponent component{};
};

/// What the file claims about an accessor.
struct GltfClaim {
  GltfRegion region;
  std::uint64_t count = 0;
  int components = 0;
  bool normalised = false;
  std::uint64_t replaced = 0;  // elements of a sparse accessor that differ
  GltfRegion indices, values;  // of those
};

struct GltfPrimitive {
  std::size_t number = 0;  // in its mesh
  std::int64_t mode = -1;  // points, lines, triangles ..., as the format numbers them
  std::int64_t indices = -1, material = -1;
  std::map<std::string, std::int64_t> attributes;  // accessors by name
};

/// Either the 16 values of a matrix, by columns, or translation (3), rotation (quaternion: x, y, z, w) and scale (3), any of them
/// empty.
struct GltfTransform {
  std::vector<double> matrix, translation, rotation, scale;
};

struct GltfNode {
  std::int64_t mesh = -1;
  std::vector<std::int64_t> children;
  std::unique_ptr<const GltfTransform> transform;  // null: none
};

/// How a material uses a texture.
struct GltfTextureUse {
  std::int64_t texture = -1;
  std::int64_t set = 0;                                 // of texture coordinates: TEXCOORD_<set>
  Eigen::Affine2d frame = Eigen::Affine2d::Identity();  // KHR_texture_transform: moves texture coordinates
};

struct GltfMaterial {
  std::string name;
  std::vector<double> colour;                            // base colour: linear red, green, blue, alpha; empty: white
  std::unique_ptr<const GltfTextureUse> colour_texture;  // of the base colour; null: none
};

struct GltfModel {
  std::vector<std::string> required_extensions;
  std::vector<GltfView> views;
  std::vector<GltfClaim> accessors;
  std::vector<std::vector<GltfPrimitive>> meshes;
  std::vector<GltfNode> nodes;
  std::vector<std::vector<std::int64_t>> scenes;  // the root nodes of each
  std::int64_t scene = -1;                        // the default one
  std::vector<GltfMaterial> materials;
  std::vector<std::int64_t> image_of_texture;
};

/// Reads the model out of the whole JSON. Takes linear time. InvalidArgument when an element of a list is no object; when a view
/// or an accessor lacks what it must have, or has an offset or count that is none.
absl::StatusOr<GltfModel> read_gltf_model(const nlohmann::json& document);

}  // namespace curvecast
