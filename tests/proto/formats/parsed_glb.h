// A .glb file taken apart again, by a reader that has nothing in common with the writer but meshopt's decoder.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace curvecast::formats {

struct ParsedGlb {
  /// Expects a whole file; with `points` above 0 one of which only the bytes of so many points are there.
  explicit ParsedGlb(std::string file, std::size_t points = 0);

  const nlohmann::json& accessor(const std::string& semantic) const;
  /// Returns the numbers of each point, normalised where the accessor says so.
  std::vector<std::vector<double>> numbers(const std::string& semantic) const;
  /// Returns a position where the node puts it.
  std::array<double, 3> in_scene(const std::vector<double>& position) const;

  nlohmann::json json;

 private:
  std::string view_bytes(std::size_t view) const;

  std::string bytes_;
  std::size_t binary_ = 0;  // where the binary chunk begins
  std::size_t points_;
};

}  // namespace curvecast::formats
