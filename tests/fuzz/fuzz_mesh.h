// What all fuzzers of mesh files do with the bytes that they are given.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/repair.h"
#include "core/mesh_io/mesh_companions.h"
#include "core/mesh_io/mesh_io.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/support/mesh_promises.h"

namespace curvecast::fuzzing {

/// Stands between the parts of an input: the mesh first, then the companions in the order in which they are asked for.
inline constexpr std::string_view kMark = "\n=== next file ===\n";

/// Each in memory of its own: nothing may be read behind it.
inline std::vector<std::vector<char>> parts_of(std::string_view input) {
  std::vector<std::vector<char>> parts;
  for (std::size_t end = input.find(kMark); end != std::string_view::npos; end = input.find(kMark)) {
    parts.emplace_back(input.begin(), input.begin() + static_cast<std::ptrdiff_t>(end));
    input.remove_prefix(end + kMark.size());
  }
  parts.emplace_back(input.begin(), input.end());
  return parts;
}

/// Reads the input as a file of this format (others are left alone: they have fuzzers of their own), whose name is `name`, asks
/// for its companions, and repairs it. Aborts where a promise is broken.
inline void fuzz_mesh(MeshFormat format, const char* name, const std::uint8_t* data, std::size_t size) {
  const std::vector<std::vector<char>> parts = parts_of({reinterpret_cast<const char*>(data), size});
  std::map<std::string, std::size_t, std::less<>> numbers;  // of the companions' parts
  const MeshFile file = {
      .name = name, .bytes = parts[0], .companion = [&](std::string_view wanted) -> std::optional<std::span<const char>> {
        expect(testing::is_safe_name(wanted), "an unsafe name is asked for");
        const std::size_t number = numbers.try_emplace(std::string(wanted), numbers.size() + 1).first->second;
        if (number >= parts.size()) return std::nullopt;
        return std::span<const char>(parts[number]);
      }};
  const absl::StatusOr<MeshFormat> detected = detect_mesh_format(file.name, file.bytes);
  if (!detected.ok() || *detected != format) return;
  const absl::StatusOr<PolygonSoup> soup = read_mesh(file);
  for (const std::string& missing : mesh_companions(file).value_or(std::vector<std::string>())) {
    expect(testing::is_safe_name(missing), "an unsafe name is missing");
  }
  if (!soup.ok()) {
    expect(absl::IsInvalidArgument(soup.status()), soup.status().ToString());
    expect(std::string(soup.status().message()).starts_with(name),
           "a message without the file's name: " + soup.status().ToString());
    return;
  }
  const std::string read = testing::broken_promise(*soup);
  expect(read.empty(), "read_mesh: " + read);
  // A glTF may show a small mesh very often, which is no fault but takes its time.
  constexpr std::size_t kMostCorners = 300'000;
  if (soup->indices.size() > kMostCorners || soup->positions.size() > kMostCorners) return;
  const absl::StatusOr<RepairedMesh> repaired = repair(*soup);
  if (!repaired.ok()) {
    expect(absl::IsInvalidArgument(repaired.status()), repaired.status().ToString());
    return;
  }
  const std::string mended = testing::broken_promise(*repaired);
  expect(mended.empty(), "repair: " + mended);
}

}  // namespace curvecast::fuzzing
