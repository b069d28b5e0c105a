// Numbers out of the buffers of a glTF file, every claim about them checked.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/mesh_io/endian.h"
#include "core/mesh_io/gltf_buffers.h"
#include "core/mesh_io/gltf_document.h"
#include "core/mesh_io/mesh_file.h"

namespace curvecast {

/// By the numbers that the format gives them.
enum class GltfComponent { kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };

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

struct GltfView {
  std::int64_t buffer = -1;
  std::uint64_t offset = 0, length = 0, stride = 0;  // bytes; stride 0: packed
};

struct GltfPlace {
  std::int64_t view = -1;
  std::uint64_t offset = 0;
  GltfComponent component{};
};

/// What the file says about an accessor.
struct GltfClaim {
  GltfPlace place;
  std::uint64_t count = 0;
  int components = 0;
  bool normalised = false;
  std::uint64_t replaced = 0;  // elements of a sparse accessor that differ
  GltfPlace indices, values;   // of those
};

class GltfAccessors {
 public:
  /// Keeps references to the first two.
  GltfAccessors(const MeshFile& file, const GltfDocument& document, std::vector<GltfView> views, std::vector<GltfClaim> claims)
      : file_bytes_(file.bytes.size()), buffers_(file, document), views_(std::move(views)), claims_(std::move(claims)) {}

  /// Accessor `index`, which must have `least` to `most` components and an element; `what` it is for goes into messages. Valid as
  /// long as this object.
  absl::StatusOr<GltfAccessor> find(std::int64_t index, int least, int most, std::string_view what);

  /// The bytes of a buffer view.
  absl::StatusOr<std::span<const char>> view(std::int64_t index);

  /// How many vertices or triangles are still in proportion to the bytes that were read.
  std::uint64_t most_elements() const;

 private:
  absl::StatusOr<GltfAccessor> resolve(const GltfClaim& claim);
  absl::Status replace(const GltfClaim& claim, std::uint64_t element, GltfAccessor& found);
  absl::StatusOr<const char*> elements(const GltfPlace& place, std::uint64_t count, std::uint64_t element, std::uint64_t stride);

  std::uint64_t file_bytes_;
  GltfBuffers buffers_;
  std::vector<GltfView> views_;
  std::vector<GltfClaim> claims_;
  std::map<std::int64_t, GltfAccessor> known_;
  std::deque<std::vector<char>> copies_;  // of sparse accessors
  std::uint64_t copied_ = 0;              // elements
};

/// "there is no node 7 (the file has 3)"
absl::Status gltf_has_no(std::string_view what, std::int64_t index, std::size_t count);

}  // namespace curvecast
