// The materials of an OBJ: named by its faces, described by its libraries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/mesh_attributes.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

/// Names and libraries point into the file's text.
class ObjMaterials {
 public:
  /// Returns the number of the material in a line `usemtl`: from 0, by first use.
  std::uint32_t use(std::string_view rest_of_line, std::size_t line);
  void note_library(std::string_view rest_of_line, std::size_t line) { libraries_.push_back({rest_of_line, line}); }
  bool any_used() const { return !used_.empty(); }
  /// Returns the materials by their numbers, from the libraries among the file's companions. What is not there is white, and
  /// warned of.
  std::vector<Material> resolve(const MeshFile& file, std::vector<std::string>& warnings) const;

 private:
  struct Place {
    std::string_view text;
    std::size_t line;
  };
  std::vector<Place> used_;
  std::vector<Place> libraries_;
  std::map<std::string_view, std::uint32_t> number_of_;
};

}  // namespace curvecast
