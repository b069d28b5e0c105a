// Primitives of a glTF that KHR_draco_mesh_compression compresses. The only door to Draco's decoder in core.
//
// That decoder trusts the counts in its input: a few dozen bytes can make it allocate gigabytes. So its start is read here first,
// and what it is about to allocate for attributes is looked at in between.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/mesh_io/gltf/gltf_model.h"

namespace curvecast {

/// An attribute that is wanted, and as what.
struct DracoRequest {
  std::int64_t id = -1;  // within the Draco data
  int components = 0;
  GltfComponent component{};
};

struct DracoMesh {
  std::vector<std::uint32_t> indices;  // three for each triangle, all below `vertices`
  std::uint64_t vertices = 0;
  std::vector<std::vector<char>> values;  // for each request, those of all vertices, packed
};

/// What the file claims outside of the Draco data.
struct DracoClaim {
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t bytes_per_vertex = 0;  // of all attributes, four at least for each component: so Draco keeps them
};

/// Returns the most triangles or vertices that so many bytes of Draco data may claim: 64 for each and 65,536 anyway (its entropy
/// coding spends next to nothing on what hardly differs), and of much data 4 for each and 4,000,000 anyway.
std::uint64_t most_draco_elements(std::uint64_t bytes);

/// Returns about how many bytes decoding takes at once at most, the result included.
std::uint64_t draco_decoding_bytes(const DracoClaim& claim);

/// Decodes a mesh. InvalidArgument, before memory is taken for it, when it is no mesh of bitstream 2.2 or has more triangles or
/// vertices than `claim` says or most_draco_elements() allows, or attributes of 16 bytes more than it says or of 512; also when
/// it is broken, and when an attribute is not there or has fewer components than asked for.
absl::StatusOr<DracoMesh> decode_draco(std::span<const char> bytes, const DracoClaim& claim,
                                       std::span<const DracoRequest> requests);

}  // namespace curvecast
