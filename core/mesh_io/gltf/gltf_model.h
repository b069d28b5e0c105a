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

/// The bytes of a view, compressed as EXT_meshopt_compression says: elements of `stride` bytes each.
struct GltfMeshopt {
  std::int64_t buffer = -1;
  std::uint64_t offset = 0, length = 0;  // bytes, compressed
  std::uint64_t stride = 0, count = 0;
  std::string mode, filter;  // as written; no filter: empty
};

/// A part of a buffer.
struct GltfView {
  std::int64_t buffer = -1;
  std::uint64_t offset = 0, length = 0, stride = 0;  // bytes; stride 0: packed
  std::unique_ptr<const GltfMeshopt> meshopt;        // where the bytes are instead; null: in the buffer
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

/// Where the vertices and triangles of a primitive are, as KHR_draco_mesh_compression says.
struct GltfDraco {
  std::int64_t view = -1;
  std::map<std::string, std::int64_t> attributes;  // the numbers within the Draco data, by names
};

struct GltfPrimitive {
  /// The format's numbers for kinds of primitives; smaller ones are points and lines.
  enum Mode : std::int64_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

  std::size_t number = 0;  // in its mesh
  std::int64_t mode = kTriangles;
  std::int64_t indices = -1, material = -1;
  std::map<std::string, std::int64_t> attributes;  // accessors by name
  std::unique_ptr<const GltfDraco> draco;          // null: the accessors have views
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
  std::vector<std::int64_t> image_of_texture;  // the WebP one (EXT_texture_webp) where there is one
};

/// Reads the model out of the whole JSON. Takes linear time. InvalidArgument when an element of a list is no object; when a view
/// or an accessor lacks what it must have, or has an offset or count that is none.
absl::StatusOr<GltfModel> read_gltf_model(const nlohmann::json& document);

}  // namespace curvecast
