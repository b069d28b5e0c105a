// Mesh files with companions, for tests.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/mesh_io/mesh_io.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

using Companions = std::map<std::string, std::string, std::less<>>;

/// All arguments must outlive the result.
inline MeshFile mesh_file(std::string_view name, const std::string& bytes, const Companions& companions) {
  return {.name = name,
          .bytes = std::span<const char>(bytes.data(), bytes.size()),
          .companion = [&companions](std::string_view wanted) -> std::optional<std::span<const char>> {
            const auto found = companions.find(wanted);
            if (found == companions.end()) return std::nullopt;
            return std::span<const char>(found->second.data(), found->second.size());
          }};
}

/// What read_mesh makes of the bytes; the test fails where it refuses them.
inline PolygonSoup soup_of(const std::string& bytes, const Companions& companions = {}) {
  const absl::StatusOr<PolygonSoup> soup = read_mesh(mesh_file("a", bytes, companions));
  EXPECT_TRUE(soup.ok()) << soup.status();
  return soup.ok() ? *soup : PolygonSoup{};
}

}  // namespace curvecast
