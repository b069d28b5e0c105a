// glTF scenes whose meshes are compressed, made in memory, for the tests of the reader.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/core/mesh_io/gltf_writer.h"
#include "tests/core/mesh_io/mesh_writers.h"

namespace curvecast {

struct DracoStyle {
  bool sequential = false;
  int metadata = 0;      // bytes of an entry that nobody needs; 0: no metadata
  int extra_floats = 0;  // of a generic attribute beside the others
};

/// A mesh in Draco's bitstream, nothing quantised: positions, attribute 0, and the colours of the vertices (RGBA), attribute 1,
/// where there are some. All faces are triangles.
std::string draco_bytes(const FileMesh& mesh, const std::vector<std::uint8_t>& colours = {}, const DracoStyle& style = {});

/// A scene of that mesh, whatever `draco` holds.
GltfWriter gltf_with_draco(const FileMesh& mesh, const std::string& draco, bool coloured = false);

/// The number of a view whose elements, `stride` bytes each, are compressed by meshoptimizer as attributes.
int meshopt_view(GltfWriter& writer, const std::string& elements, int stride, const char* filter = nullptr);

/// A scene of the mesh, its positions and indices compressed by meshoptimizer: indices as triangles, or else as a sequence.
GltfWriter gltf_with_meshopt(const FileMesh& mesh, bool as_triangles = true);

}  // namespace curvecast
