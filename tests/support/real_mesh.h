// Meshes that were scanned or modelled, not generated.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace curvecast::testing {

/// The bytes of a mesh file.
struct RealMesh {
  std::string name;  // of the file, for its ending
  std::string bytes;
};

/// Reads a mesh of the folder that $CURVECAST_MESHES names (without it: ../shared/meshes beside the project). Where the folder
/// does not have it, reads the mesh of Debian's libcgal-demo that stands in for it: of a like shape, so that the same must hold
/// for it. Fails the running test, and returns an empty file, where neither is there or `name` is unknown.
RealMesh real_mesh(std::string_view name);

/// The names that real_mesh() knows: all kinds of topology.
std::vector<const char*> real_mesh_names();

}  // namespace curvecast::testing
