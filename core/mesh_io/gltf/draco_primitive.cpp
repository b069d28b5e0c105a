#include "core/mesh_io/gltf/draco_primitive.h"

#include <absl/strings/str_format.h>
#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/decoder_buffer.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cstring>
#include <string_view>

namespace curvecast {
namespace {

// Of all attributes together; glTF's largest are of 16. Draco may keep some that the file does not mention.
constexpr std::uint64_t kMostBytesPerVertex = 512, kUnmentioned = 16;

absl::Status broken(std::string_view what) {
  return absl::InvalidArgumentError(absl::StrFormat("its Draco data is broken: %s", what));
}

struct Start {
  std::uint8_t method = 0;
  std::uint32_t triangles = 0, vertices = 0;  // of an edgebreaker mesh, vertices with several values of an attribute count once
};

/// Passes over the metadata, of which a glTF has no use and Draco makes a tree of small strings.
absl::Status skip_metadata(draco::DecoderBuffer& from) {
  constexpr std::int64_t kMostMetadata = 65'536;
  const std::int64_t begin = from.decoded_size();
  const auto skip = [&](std::uint64_t bytes) {
    if (bytes > static_cast<std::uint64_t>(from.remaining_size())) return false;
    from.Advance(static_cast<std::int64_t>(bytes));
    return true;
  };
  const auto skip_name = [&] {
    std::uint8_t length = 0;
    return from.Decode(&length) && skip(length);
  };
  const auto skip_tree = [&] {
    std::uint64_t left = 1;
    for (bool is_root = true; left > 0; is_root = false, --left) {
      std::uint32_t entries = 0, children = 0;
      if ((!is_root && !skip_name()) || !draco::DecodeVarint(&entries, &from)) return false;
      for (std::uint32_t i = 0; i < entries; ++i) {
        std::uint32_t length = 0;
        if (!skip_name() || !draco::DecodeVarint(&length, &from) || !skip(length)) return false;
      }
      if (!draco::DecodeVarint(&children, &from)) return false;
      left += children;
    }
    return true;
  };
  std::uint32_t attributes = 0;
  bool good = draco::DecodeVarint(&attributes, &from);
  for (std::uint32_t i = 0; good && i < attributes; ++i) {
    std::uint32_t id = 0;
    good = draco::DecodeVarint(&id, &from) && skip_tree();
  }
  if (!good || !skip_tree()) return broken("it ends within its metadata");
  const std::int64_t size = from.decoded_size() - begin;
  return size <= kMostMetadata ? absl::OkStatus() : broken(absl::StrFormat("%d bytes of metadata are too many", size));
}

absl::StatusOr<Start> read_start(std::span<const char> bytes) {
  constexpr std::size_t kHeader = 11;
  constexpr std::uint16_t kHasMetadata = 0x8000;
  if (bytes.size() < kHeader || std::memcmp(bytes.data(), "DRACO", 5) != 0) return broken("it does not begin with DRACO");
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); };
  if (byte(5) != 2 || byte(6) != 2) {
    return absl::InvalidArgumentError(
        absl::StrFormat("its Draco data has version %d.%d of the bitstream; glTF wants 2.2", byte(5), byte(6)));
  }
  if (byte(7) != draco::TRIANGULAR_MESH) return absl::InvalidArgumentError("its Draco data is no mesh");
  draco::DecoderBuffer from;
  from.Init(bytes.data(), bytes.size());
  from.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
  from.Advance(kHeader);
  if (((byte(10) << 8 | byte(9)) & kHasMetadata) != 0) {
    if (absl::Status status = skip_metadata(from); !status.ok()) return status;
  }
  Start start{.method = byte(8)};
  bool good = false;
  if (start.method == draco::MESH_EDGEBREAKER_ENCODING) {
    std::uint8_t traversal = 0;
    good = from.Decode(&traversal) && draco::DecodeVarint(&start.vertices, &from) && draco::DecodeVarint(&start.triangles, &from);
  } else if (start.method == draco::MESH_SEQUENTIAL_ENCODING) {
    good = draco::DecodeVarint(&start.triangles, &from) && draco::DecodeVarint(&start.vertices, &from);
  } else {
    return broken(absl::StrFormat("there is no way %d to encode a mesh", start.method));
  }
  if (!good) return broken("it ends within its header");
  return start;
}

absl::Status check_counts(const Start& start, const DracoClaim& claim, std::uint64_t bytes) {
  const auto check = [&](std::uint64_t count, std::uint64_t claimed, const char* what) {
    if (count > claimed) {
      return absl::InvalidArgumentError(
          absl::StrFormat("its Draco data has %d %s, but the accessors claim %d", count, what, claimed));
    }
    if (count > most_draco_elements(bytes)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("its Draco data claims %d %s, more than is in proportion to its %d bytes", count, what, bytes));
    }
    return absl::OkStatus();
  };
  absl::Status status = check(start.triangles, claim.triangles, "triangles");
  status.Update(check(start.vertices, claim.vertices, "vertices"));
  return status;
}

/// What all attributes together take for each vertex, as they are told and as they are kept while they are decoded.
std::uint64_t bytes_per_vertex(const draco::PointCloud& mesh) {
  std::uint64_t bytes = 0;
  for (int i = 0; i < mesh.num_attributes(); ++i) {
    const draco::PointAttribute& attribute = *mesh.attribute(i);
    bytes += static_cast<std::uint64_t>(attribute.num_components()) *
             static_cast<std::uint64_t>(std::max(4, draco::DataTypeLength(attribute.data_type())));
  }
  return bytes;
}

/// Draco's decoder, stopped before it takes more memory for its attributes than was foreseen.
template <class Decoder>
class BoundedDecoder : public Decoder {
 public:
  explicit BoundedDecoder(const DracoClaim& claim)
      : most_vertices_(claim.vertices), most_bytes_(std::min(kMostBytesPerVertex, claim.bytes_per_vertex + kUnmentioned)) {}

  const absl::Status& refused() const { return refused_; }

 protected:
  bool DecodeAllAttributes() override {
    const std::uint64_t vertices = this->mesh()->num_points(), bytes = bytes_per_vertex(*this->mesh());
    if (vertices > most_vertices_) {
      refused_ = absl::InvalidArgumentError(
          absl::StrFormat("its Draco data has %d vertices, but the accessors claim %d", vertices, most_vertices_));
    } else if (bytes > most_bytes_) {
      refused_ = absl::InvalidArgumentError(
          absl::StrFormat("its Draco data has attributes of %d bytes for each vertex, more than %d", bytes, most_bytes_));
    }
    return refused_.ok() && Decoder::DecodeAllAttributes();
  }

 private:
  const std::uint64_t most_vertices_, most_bytes_;
  absl::Status refused_;
};

template <class Decoder>
absl::Status decode(std::span<const char> bytes, const DracoClaim& claim, draco::Mesh& mesh) {
  draco::DecoderBuffer from;
  from.Init(bytes.data(), bytes.size());
  const draco::DecoderOptions options;
  BoundedDecoder<Decoder> decoder(claim);
  const draco::Status status = decoder.Decode(options, &from, &mesh);
  if (!decoder.refused().ok()) return decoder.refused();
  return status.ok() ? absl::OkStatus() : broken(status.error_msg_string());
}

template <class T>
absl::Status copy_values(const draco::PointAttribute& attribute, std::uint64_t vertices, const DracoRequest& request,
                         std::vector<char>& out) {
  const std::size_t element = sizeof(T) * static_cast<std::size_t>(request.components);
  out.resize(vertices * element);
  std::vector<T> value(static_cast<std::size_t>(request.components));
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const draco::AttributeValueIndex at = attribute.mapped_index(draco::PointIndex(i));
    if (at.value() >= attribute.size() ||
        !attribute.ConvertValue<T>(at, static_cast<std::int8_t>(request.components), value.data())) {
      return broken(absl::StrFormat("attribute %d has no value for vertex %d", request.id, i));
    }
    std::memcpy(out.data() + i * element, value.data(), element);
  }
  return absl::OkStatus();
}

absl::Status copy_attribute(const draco::Mesh& mesh, const DracoRequest& request, std::vector<char>& out) {
  const draco::PointAttribute* const attribute =
      request.id >= 0 && request.id <= UINT32_MAX ? mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(request.id)) : nullptr;
  if (attribute == nullptr) return absl::InvalidArgumentError(absl::StrFormat("its Draco data has no attribute %d", request.id));
  if (attribute->num_components() < request.components) {
    return absl::InvalidArgumentError(absl::StrFormat("attribute %d of its Draco data has %d components, and the accessor %d",
                                                      request.id, attribute->num_components(), request.components));
  }
  const std::uint64_t vertices = mesh.num_points();
  switch (request.component) {
    case GltfComponent::kInt8:
      return copy_values<std::int8_t>(*attribute, vertices, request, out);
    case GltfComponent::kUint8:
      return copy_values<std::uint8_t>(*attribute, vertices, request, out);
    case GltfComponent::kInt16:
      return copy_values<std::int16_t>(*attribute, vertices, request, out);
    case GltfComponent::kUint16:
      return copy_values<std::uint16_t>(*attribute, vertices, request, out);
    case GltfComponent::kUint32:
      return copy_values<std::uint32_t>(*attribute, vertices, request, out);
    case GltfComponent::kFloat:
      return copy_values<float>(*attribute, vertices, request, out);
  }
  return absl::InvalidArgumentError("its numbers are of an unknown type");
}

absl::StatusOr<DracoMesh> copy_mesh(const draco::Mesh& mesh, std::span<const DracoRequest> requests) {
  DracoMesh out{.indices = {}, .vertices = mesh.num_points(), .values = std::vector<std::vector<char>>(requests.size())};
  out.indices.reserve(3 * std::size_t{mesh.num_faces()});
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
      if (corner.value() >= out.vertices) return broken(absl::StrFormat("triangle %d has a vertex that is not there", f));
      out.indices.push_back(corner.value());
    }
  }
  for (std::size_t i = 0; i < requests.size(); ++i) {
    if (absl::Status status = copy_attribute(mesh, requests[i], out.values[i]); !status.ok()) return status;
  }
  return out;
}

}  // namespace

std::uint64_t most_draco_elements(std::uint64_t bytes) { return std::min(65'536 + 64 * bytes, 4'000'000 + 4 * bytes); }

std::uint64_t draco_decoding_bytes(const DracoClaim& claim) {
  constexpr std::uint64_t kPerTriangle = 100, kPerVertex = 40;  // measured; attributes are kept twice
  return kPerTriangle * claim.triangles + (kPerVertex + 2 * (claim.bytes_per_vertex + kUnmentioned)) * claim.vertices;
}

absl::StatusOr<DracoMesh> decode_draco(std::span<const char> bytes, const DracoClaim& claim,
                                       std::span<const DracoRequest> requests) {
  const absl::StatusOr<Start> start = read_start(bytes);
  if (!start.ok()) return start.status();
  if (absl::Status status = check_counts(*start, claim, bytes.size()); !status.ok()) return status;
  draco::Mesh mesh;
  const absl::Status status = start->method == draco::MESH_EDGEBREAKER_ENCODING
                                  ? decode<draco::MeshEdgebreakerDecoder>(bytes, claim, mesh)
                                  : decode<draco::MeshSequentialDecoder>(bytes, claim, mesh);
  if (!status.ok()) return status;
  return copy_mesh(mesh, requests);
}

}  // namespace curvecast
