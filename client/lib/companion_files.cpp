// SPDX-License-Identifier: Apache-2.0
#include "client/lib/companion_files.h"

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

namespace curvecast::client {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kReferringEndings = {".obj", ".gltf", ".glb", ".ply"};
// A server may name any file of the folder. It has no use for others than these.
constexpr std::array<std::string_view, 10> kCompanionEndings = {".mtl", ".bin", ".png", ".jpg",  ".jpeg",
                                                                ".bmp", ".tga", ".gif", ".webp", ".ktx2"};

template <std::size_t N>
bool ends_in(const fs::path& path, const std::array<std::string_view, N>& endings) {
  const std::string ending = absl::AsciiStrToLower(path.extension().string());
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

/// Why a name cannot be taken, or nothing. A hidden file is no part of a mesh; `..` and `.` begin with a dot, too.
absl::string_view objection_to(const fs::path& name) {
  if (name.empty() || name.native().find('\0') != std::string::npos) return "is no name of a file";
  if (name.is_absolute()) return "is not relative to the mesh's folder";
  for (const fs::path& part : name) {
    if (part.empty() || part.native().starts_with('.')) return "goes up or through a hidden folder";
  }
  if (!ends_in(name, kCompanionEndings)) return "is no material library, buffer or picture";
  return {};
}

bool is_within(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace

bool may_have_companions(std::string_view path) { return ends_in(fs::path(path), kReferringEndings); }

absl::StatusOr<InputFile> open_companion(const std::string& mesh_path, std::string_view name) {
  const auto refused = [&](absl::string_view why) {
    return absl::InvalidArgumentError(
        absl::StrCat(mesh_path, " refers to \"", absl::Utf8SafeCHexEscape({name.data(), name.size()}), "\", which ", why));
  };
  const fs::path relative(name);
  if (const absl::string_view objection = objection_to(relative); !objection.empty()) return refused(objection);
  const fs::path parent = fs::path(mesh_path).parent_path();
  std::error_code error;
  const fs::path folder = fs::canonical(parent.empty() ? "." : parent, error);
  if (error) return absl::NotFoundError(absl::StrCat(mesh_path, ": its folder is not there: ", error.message()));
  const fs::path file = fs::canonical(folder / relative, error);
  if (error) return absl::NotFoundError(absl::StrCat((folder / relative).string(), ": ", error.message()));
  if (!is_within(file, folder)) return refused("leads out of the mesh's folder");
  return InputFile::open(file.string());
}

}  // namespace curvecast::client
