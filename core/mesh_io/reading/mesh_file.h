// A mesh file in memory and the files that it refers to.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace curvecast {

struct MeshFile {
  std::string_view name;        // as the user knows it: helps to detect the format, and starts every message
  std::span<const char> bytes;  // whole
  /// The bytes of a file that this one refers to (a material library, a texture, a buffer), by the name that mesh_companions
  /// gives: relative, with forward slashes, never out of the mesh's folder. nullopt: not there. The bytes outlive the call that
  /// is given the MeshFile. May be empty: then there are none.
  std::function<std::optional<std::span<const char>>(std::string_view name)> companion = {};

  std::string_view text() const { return {bytes.data(), bytes.size()}; }
};

}  // namespace curvecast
