#include "core/mesh_io/gltf/gltf_accessor.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/mesh_io/gltf/meshopt_view.h"
#include "core/mesh_io/reading/companion_name.h"
#include "core/mesh_io/reading/mesh_reading.h"

namespace curvecast {
namespace {

/// 0 for types that there are not.
std::uint64_t component_bytes(GltfComponent component) {
  switch (component) {
    case GltfComponent::kInt8:
    case GltfComponent::kUint8:
      return 1;
    case GltfComponent::kInt16:
    case GltfComponent::kUint16:
      return 2;
    case GltfComponent::kUint32:
    case GltfComponent::kFloat:
      return 4;
  }
  return 0;
}

}  // namespace

absl::Status gltf_has_no(std::string_view what, std::int64_t index, std::size_t count) {
  return absl::InvalidArgumentError(absl::StrFormat("there is no %s %d (the file has %d)", what, index, count));
}

absl::StatusOr<std::span<const char>> GltfBuffers::buffer(std::int64_t index) {
  if (const auto known = known_.find(index); known != known_.end()) return known->second;
  absl::StatusOr<std::span<const char>> bytes = find(index);
  if (!bytes.ok()) return bytes.status();
  const std::uint64_t claimed = document_.buffers[static_cast<std::size_t>(index)].byte_length;
  if (claimed > bytes->size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("buffer %d claims %d bytes, but there are only %d: it is truncated", index, claimed, bytes->size()));
  }
  bytes_used_ += claimed;
  return known_[index] = bytes->first(claimed);
}

absl::StatusOr<std::span<const char>> GltfBuffers::slice(std::int64_t index, std::uint64_t offset, std::uint64_t length) {
  absl::StatusOr<std::span<const char>> bytes = buffer(index);
  if (!bytes.ok()) return bytes.status();
  if (offset > bytes->size() || length > bytes->size() - offset) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d bytes at %d reach beyond buffer %d, which has %d", length, offset, index, bytes->size()));
  }
  return bytes->subspan(offset, length);
}

absl::StatusOr<std::span<const char>> GltfBuffers::find(std::int64_t index) {
  if (index < 0 || index >= static_cast<std::int64_t>(document_.buffers.size())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("there is no buffer %d (the file has %d)", index, document_.buffers.size()));
  }
  const GltfSource& source = document_.buffers[static_cast<std::size_t>(index)];
  if (!source.data_uri.empty()) {
    absl::StatusOr<std::string> decoded = decode_data_uri(source.data_uri);
    if (!decoded.ok()) return absl::InvalidArgumentError(absl::StrFormat("buffer %d: %s", index, decoded.status().message()));
    const std::string& kept = decoded_[index] = *std::move(decoded);
    return std::span<const char>(kept);
  }
  if (source.binary_chunk && document_.binary_chunk) return *document_.binary_chunk;
  if (source.file.empty()) return absl::InvalidArgumentError(absl::StrFormat("buffer %d has no bytes anywhere", index));
  const std::optional<std::string> name = safe_companion_name(source.file);
  const auto bytes = name && file_.companion ? file_.companion(*name) : std::nullopt;
  if (bytes) return *bytes;
  return absl::InvalidArgumentError(absl::StrFormat("buffer %d is in the file '%s', which is not there beside the mesh", index,
                                                    display_name(name ? *name : source.file)));
}

std::uint64_t GltfAccessors::most_elements() const {
  constexpr std::uint64_t kAnyway = 4'000'000;
  constexpr std::uint64_t kBytesEach = 4;
  return std::min<std::uint64_t>(kAnyway + (file_bytes_ + buffers_.bytes_used() + decoded_bytes_) / kBytesEach, UINT32_MAX / 3);
}

absl::StatusOr<GltfAccessor> GltfAccessors::find(const GltfPrimitive& primitive, std::int64_t index, int least, int most,
                                                 std::string_view what) {
  if (index < 0 || index >= static_cast<std::int64_t>(claims_.size())) return gltf_has_no("accessor", index, claims_.size());
  const GltfClaim& claim = claims_[static_cast<std::size_t>(index)];
  absl::Status status;
  if (claim.components < least || claim.components > most) {
    status = absl::InvalidArgumentError("it has the wrong number of components");
  } else if (const auto known = known_.find(key(primitive, index)); known != known_.end()) {
    return known->second;
  } else {
    absl::StatusOr<GltfAccessor> found = resolve(claim);
    if (found.ok()) return known_[key(primitive, index)] = *found;
    status = found.status();
  }
  return absl::InvalidArgumentError(absl::StrFormat("accessor %d (%s): %s", index, what, status.message()));
}

absl::StatusOr<std::span<const char>> GltfAccessors::view(std::int64_t index) {
  if (index < 0 || index >= static_cast<std::int64_t>(views_.size())) return gltf_has_no("buffer view", index, views_.size());
  const GltfView& view = views_[static_cast<std::size_t>(index)];
  if (view.meshopt == nullptr) return buffers_.slice(view.buffer, view.offset, view.length);
  absl::StatusOr<std::span<const char>> decoded = decoded_view(index);
  if (decoded.ok()) return decoded;
  return absl::InvalidArgumentError(absl::StrFormat("buffer view %d: %s", index, decoded.status().message()));
}

// ------------------------------------------------------------------------------------------------------------ what is compressed

absl::StatusOr<std::span<const char>> GltfAccessors::decoded_view(std::int64_t index) {
  if (const auto known = decoded_views_.find(index); known != decoded_views_.end()) return std::span<const char>(known->second);
  const GltfMeshopt& packed = *views_[static_cast<std::size_t>(index)].meshopt;
  const absl::StatusOr<std::span<const char>> bytes = buffers_.slice(packed.buffer, packed.offset, packed.length);
  if (!bytes.ok()) return bytes.status();
  if (absl::Status status = count_packed(bytes->size()); !status.ok()) return status;
  absl::StatusOr<std::vector<char>> decoded = decode_meshopt(packed, *bytes);
  if (!decoded.ok()) return decoded.status();
  decoded_bytes_ += decoded->size();
  return std::span<const char>(decoded_views_[index] = *std::move(decoded));
}

// Any number of views may show the same bytes. Each time they are decoded they take memory and time.
absl::Status GltfAccessors::count_packed(std::uint64_t bytes) {
  packed_bytes_ += bytes;
  if (packed_bytes_ <= 2 * (file_bytes_ + buffers_.bytes_used())) return absl::OkStatus();
  return absl::InvalidArgumentError("the same compressed bytes are used over and over");
}

absl::Status GltfAccessors::unpack(const GltfPrimitive& primitive) {
  if (primitive.draco == nullptr) return absl::OkStatus();
  absl::Status status = unpack_draco(primitive);
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrFormat("buffer view %d: %s", primitive.draco->view, status.message()));
}

absl::Status GltfAccessors::unpack_draco(const GltfPrimitive& primitive) {
  const absl::StatusOr<DracoClaim> claim = draco_claim(primitive, claims_);
  if (!claim.ok()) return claim.status();
  std::vector<std::int64_t> wanted;
  std::vector<DracoRequest> requests;
  for (const auto& [name, id] : primitive.draco->attributes) {
    const auto attribute = primitive.attributes.find(name);
    if (attribute == primitive.attributes.end() || known_.contains(key(primitive, attribute->second))) continue;
    const std::int64_t index = attribute->second;
    if (index < 0 || index >= static_cast<std::int64_t>(claims_.size())) return gltf_has_no("accessor", index, claims_.size());
    const GltfClaim& accessor = claims_[static_cast<std::size_t>(index)];
    wanted.push_back(index);
    requests.push_back({.id = id, .components = accessor.components, .component = accessor.region.component});
  }
  if (requests.empty() && known_.contains(key(primitive, primitive.indices))) return absl::OkStatus();
  const absl::StatusOr<std::span<const char>> bytes = view(primitive.draco->view);
  if (!bytes.ok()) return bytes.status();
  if (absl::Status status = count_packed(bytes->size()); !status.ok()) return status;
  absl::StatusOr<DracoMesh> decoded = decode_draco(*bytes, *claim, requests);
  if (!decoded.ok()) return decoded.status();
  const DracoMesh& mesh = draco_meshes_.emplace_back(*std::move(decoded));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const GltfClaim& accessor = claims_[static_cast<std::size_t>(wanted[i])];
    known_[key(primitive, wanted[i])] = {.data = mesh.values[i].data(),
                                         .count = mesh.vertices,
                                         .stride = mesh.vertices > 0 ? mesh.values[i].size() / mesh.vertices : 0,
                                         .components = accessor.components,
                                         .component = accessor.region.component,
                                         .normalised = accessor.normalised};
    decoded_bytes_ += mesh.values[i].size();
  }
  known_[key(primitive, primitive.indices)] = {.data = reinterpret_cast<const char*>(mesh.indices.data()),
                                               .count = mesh.indices.size(),
                                               .stride = sizeof(std::uint32_t),
                                               .components = 1,
                                               .component = GltfComponent::kUint32};
  decoded_bytes_ += mesh.indices.size() * sizeof(std::uint32_t);
  return absl::OkStatus();
}

absl::StatusOr<DracoClaim> draco_claim(const GltfPrimitive& primitive, const std::vector<GltfClaim>& accessors) {
  const auto accessor = [&](std::int64_t index) {
    const bool is_there = index >= 0 && index < static_cast<std::int64_t>(accessors.size());
    return is_there ? &accessors[static_cast<std::size_t>(index)] : nullptr;
  };
  const auto position = primitive.attributes.find("POSITION");
  const GltfClaim* const indices = accessor(primitive.indices);
  const GltfClaim* const vertices = position != primitive.attributes.end() ? accessor(position->second) : nullptr;
  if (indices == nullptr || vertices == nullptr) {
    return absl::InvalidArgumentError("Draco data needs accessors for positions and indices beside it");
  }
  const bool is_strip = primitive.mode == GltfPrimitive::kTriangleStrip;
  DracoClaim claim{.triangles = is_strip ? indices->count : indices->count / 3, .vertices = vertices->count};
  for (const auto& [name, index] : primitive.attributes) {
    if (const GltfClaim* const attribute = accessor(index)) {
      claim.bytes_per_vertex += 4 * static_cast<std::uint64_t>(attribute->components);
    }
  }
  return claim;
}

// --------------------------------------------------------------------------------------------------------------------- accessors

absl::StatusOr<GltfAccessor> GltfAccessors::resolve(const GltfClaim& claim) {
  const std::uint64_t size = component_bytes(claim.region.component);
  if (size == 0) return absl::InvalidArgumentError("its numbers are of an unknown type");
  if (claim.count == 0) return absl::InvalidArgumentError("it is empty");
  if (claim.region.view < 0 && claim.replaced == 0) return absl::InvalidArgumentError("it has no buffer view");
  const std::uint64_t element = size * static_cast<std::uint64_t>(claim.components);
  GltfAccessor found{.count = claim.count,
                     .stride = element,
                     .components = claim.components,
                     .component = claim.region.component,
                     .normalised = claim.normalised};
  if (claim.region.view >= 0) {
    if (claim.region.view < static_cast<std::int64_t>(views_.size())) {
      const std::uint64_t stride = views_[static_cast<std::size_t>(claim.region.view)].stride;
      if (stride != 0) found.stride = stride;
    }
    const absl::StatusOr<const char*> data = elements(claim.region, found.count, element, found.stride);
    if (!data.ok()) return data.status();
    found.data = *data;
  }
  if (claim.replaced > 0) {
    if (absl::Status status = replace(claim, element, found); !status.ok()) return status;
  }
  return found;
}

// Where the elements begin: `count` of `element` bytes, `stride` apart.
absl::StatusOr<const char*> GltfAccessors::elements(const GltfRegion& region, std::uint64_t count, std::uint64_t element,
                                                    std::uint64_t stride) {
  const absl::StatusOr<std::span<const char>> bytes = view(region.view);
  if (!bytes.ok()) return bytes.status();
  const std::uint64_t size = bytes->size();
  if (stride < element) {
    return absl::InvalidArgumentError(
        absl::StrFormat("its elements of %d bytes overlap: the buffer view's stride is %d", element, stride));
  }
  if (region.offset > size || size - region.offset < element || (size - region.offset - element) / stride < count - 1) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d elements, %d bytes apart, at %d reach beyond buffer view %d of %d bytes", count, stride,
                        region.offset, region.view, size));
  }
  return bytes->data() + region.offset;
}

// By a copy of the elements, zero without a buffer view, with some replaced.
absl::Status GltfAccessors::replace(const GltfClaim& claim, std::uint64_t element, GltfAccessor& found) {
  if (claim.replaced > claim.count) return absl::InvalidArgumentError("it replaces more elements than it has");
  // Without a buffer view they cost the file nothing, and hardly any file has them.
  constexpr std::uint64_t kAnyway = 65'536;
  const std::uint64_t most = kAnyway + file_bytes_ + buffers_.bytes_used();
  if (claim.count > most || (copied_ += claim.count) > most) {
    return absl::InvalidArgumentError("sparse accessors claim more elements than are in proportion to the file");
  }
  GltfAccessor places{.count = claim.replaced,
                      .stride = component_bytes(claim.indices.component),
                      .components = 1,
                      .component = claim.indices.component};
  if (!places.is_index()) return absl::InvalidArgumentError("its sparse indices are of no type for indices");
  const absl::StatusOr<const char*> indices = elements(claim.indices, claim.replaced, places.stride, places.stride);
  if (!indices.ok()) return indices.status();
  const absl::StatusOr<const char*> values = elements(claim.values, claim.replaced, element, element);
  if (!values.ok()) return values.status();
  places.data = *indices;
  std::vector<char>& copy = copies_.emplace_back(claim.count * element);
  for (std::uint64_t i = 0; found.data != nullptr && i < claim.count; ++i) {
    std::copy_n(found.data + i * found.stride, element, copy.data() + i * element);
  }
  for (std::uint64_t i = 0; i < claim.replaced; ++i) {
    const std::uint32_t place = places.index(i);
    if (place >= claim.count) return absl::InvalidArgumentError(index_out_of_range(place, claim.count));
    std::copy_n(*values + i * element, element, copy.data() + place * element);
  }
  found.data = copy.data();
  found.stride = element;
  return absl::OkStatus();
}

}  // namespace curvecast
