// Numbers out of the buffers of a glTF file, every claim about them checked.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/mesh_io/gltf/draco_primitive.h"
#include "core/mesh_io/gltf/gltf_document.h"
#include "core/mesh_io/reading/endian.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

/// `count` elements of some components each; every byte is there.
struct GltfAccessor {
  const char* data = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;  // bytes
  int components = 0;
  GltfComponent component{};
  bool normalised = false;  // integers stand for 0 .. 1 or -1 .. 1

  /// Component c of element i.
  double number(std::size_t i, int c) const {
    const char* const p = data + i * stride;
    switch (component) {
      case GltfComponent::kInt8:
        return signed_number(load<std::int8_t, false>(p + c), 127);
      case GltfComponent::kUint8:
        return load<std::uint8_t, false>(p + c) / (normalised ? 255.0 : 1.0);
      case GltfComponent::kInt16:
        return signed_number(load<std::int16_t, false>(p + 2 * c), 32'767);
      case GltfComponent::kUint16:
        return load<std::uint16_t, false>(p + 2 * c) / (normalised ? 65'535.0 : 1.0);
      case GltfComponent::kUint32:
        return load<std::uint32_t, false>(p + 4 * c);
      case GltfComponent::kFloat:
        break;
    }
    return static_cast<double>(load<float, false>(p + 4 * c));
  }
  /// Component 0 of element i, of an unsigned type.
  std::uint32_t index(std::size_t i) const {
    const char* const p = data + i * stride;
    if (component == GltfComponent::kUint8) return load<std::uint8_t, false>(p);
    if (component == GltfComponent::kUint16) return load<std::uint16_t, false>(p);
    return load<std::uint32_t, false>(p);
  }
  bool is_index() const {
    return components == 1 &&
           (component == GltfComponent::kUint8 || component == GltfComponent::kUint16 || component == GltfComponent::kUint32);
  }

 private:
  double signed_number(int value, int largest) const {
    if (!normalised) return value;
    return value < -largest ? -1.0 : value / static_cast<double>(largest);
  }
};

/// The bytes behind a glTF: out of the file itself, or of its companions.
class GltfBuffers {
 public:
  /// Keeps references to both.
  GltfBuffers(const MeshFile& file, const GltfDocument& document) : file_(file), document_(document) {}

  /// Returns the bytes of buffer `index`: as many as it claims. They live as long as this object. InvalidArgument when there is
  /// no such buffer, or not all of its bytes.
  absl::StatusOr<std::span<const char>> buffer(std::int64_t index);

  /// Returns the part [offset, offset + length) of buffer `index`.
  absl::StatusOr<std::span<const char>> slice(std::int64_t index, std::uint64_t offset, std::uint64_t length);

  /// Returns the bytes of all buffers that were asked for so far.
  std::uint64_t bytes_used() const { return bytes_used_; }

 private:
  absl::StatusOr<std::span<const char>> find(std::int64_t index);

  const MeshFile& file_;
  const GltfDocument& document_;
  std::map<std::int64_t, std::span<const char>> known_;
  std::map<std::int64_t, std::string> decoded_;
  std::uint64_t bytes_used_ = 0;
};

class GltfAccessors {
 public:
  /// Keeps references to both.
  GltfAccessors(const MeshFile& file, const GltfDocument& document)
      : file_bytes_(file.bytes.size()),
        buffers_(file, document),
        views_(document.model.views),
        claims_(document.model.accessors) {}

  /// Finds accessor `index`, which must have `least` to `most` components and an element; `what` it is for goes into messages.
  /// The result is valid as long as this object. Its elements are those in the Draco data of `primitive`, if that has any.
  absl::StatusOr<GltfAccessor> find(const GltfPrimitive& primitive, std::int64_t index, int least, int most,
                                    std::string_view what);

  /// Decodes the Draco data of a primitive, if it has any: before any of its accessors is looked for.
  absl::Status unpack(const GltfPrimitive& primitive);

  /// Returns the bytes of a buffer view, decoded if they are compressed. They live as long as this object.
  absl::StatusOr<std::span<const char>> view(std::int64_t index);

  /// Whether anything has been decoded so far.
  bool has_decoded() const { return decoded_bytes_ > 0; }

  /// Returns how many vertices or triangles are still in proportion to the bytes that were read.
  std::uint64_t most_elements() const;

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;  // the view of Draco data, -1 for none, and the accessor

  static Key key(const GltfPrimitive& primitive, std::int64_t index) {
    return {primitive.draco != nullptr ? primitive.draco->view : -1, index};
  }
  absl::StatusOr<std::span<const char>> decoded_view(std::int64_t index);
  absl::Status count_packed(std::uint64_t bytes);
  absl::Status unpack_draco(const GltfPrimitive& primitive);
  absl::StatusOr<GltfAccessor> resolve(const GltfClaim& claim);
  absl::Status replace(const GltfClaim& claim, std::uint64_t element, GltfAccessor& found);
  absl::StatusOr<const char*> elements(const GltfRegion& region, std::uint64_t count, std::uint64_t element,
                                       std::uint64_t stride);

  std::uint64_t file_bytes_;
  GltfBuffers buffers_;
  const std::vector<GltfView>& views_;
  const std::vector<GltfClaim>& claims_;
  std::map<Key, GltfAccessor> known_;
  std::map<std::int64_t, std::vector<char>> decoded_views_;
  std::deque<DracoMesh> draco_meshes_;
  std::uint64_t packed_bytes_ = 0, decoded_bytes_ = 0;
  std::deque<std::vector<char>> copies_;  // of sparse accessors
  std::uint64_t copied_ = 0;              // elements
};

/// What the accessors of a primitive with Draco data claim about it. InvalidArgument when it lacks positions or indices.
absl::StatusOr<DracoClaim> draco_claim(const GltfPrimitive& primitive, const std::vector<GltfClaim>& accessors);

/// Words an error: "there is no node 7 (the file has 3)".
absl::Status gltf_has_no(std::string_view what, std::int64_t index, std::size_t count);

}  // namespace curvecast
