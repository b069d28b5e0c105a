// The textures of one mesh: each decoded once, all together within a bound; what cannot be had becomes a warning.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/image.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

/// Appends a whole sentence; after a few dozen only says that there are more.
void add_warning(std::vector<std::string>& warnings, std::string sentence);

/// "line 12: `message`" as a warning: the readers' messages begin that way.
void add_warning(std::vector<std::string>& warnings, std::size_t line, std::string_view message);

class TextureLoader {
 public:
  static constexpr std::uint64_t kMostPixels = 1 << 26;  // of all textures of a mesh: 256 MiB

  /// Keeps references to both.
  TextureLoader(const MeshFile& file, std::vector<std::string>& warnings) : file_(file), warnings_(warnings) {}

  /// Loads the texture that is called `written` in the mesh or in its companion `parent` (empty: the mesh). Warnings begin with
  /// `where`, such as "line 3 of a.mtl". Null when there is none to be had.
  std::shared_ptr<const Image> load(std::string_view written, std::string_view parent, std::string_view where);

  /// Decodes the texture in `bytes`, called `name` in warnings.
  std::shared_ptr<const Image> decode(std::span<const char> bytes, std::string_view name, std::string_view where);

 private:
  const MeshFile& file_;
  std::vector<std::string>& warnings_;
  std::map<std::string, std::shared_ptr<const Image>> known_;
  std::uint64_t pixels_left_ = kMostPixels;
};

}  // namespace curvecast
