#include "client/cli/points_io.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "client/cli/common.h"
#include "client/lib/file_bytes.h"
#include "client/lib/point_file.h"

namespace curvecast::cli {
namespace {

constexpr std::uint64_t kMaxPlyHeader = 64 << 10;  // bytes looked at

std::string ending_of(const std::string& path) { return absl::AsciiStrToLower(std::filesystem::path(path).extension().string()); }

/// Whether a PLY header declares faces or triangle strips. What is broken counts as a mesh, whose reader says what is wrong.
bool ply_declares_faces(absl::string_view start) {
  for (absl::string_view line : absl::StrSplit(start, '\n')) {
    line = absl::StripAsciiWhitespace(line);
    if (line == "end_header") return false;
    const std::vector<absl::string_view> words = absl::StrSplit(line, ' ', absl::SkipEmpty());
    std::uint64_t count = 0;
    if (words.size() == 3 && words[0] == "element" && (words[1] == "face" || words[1] == "tristrips") &&
        (!absl::SimpleAtoi(words[2], &count) || count > 0)) {
      return true;
    }
  }
  return true;
}

}  // namespace

absl::Status check_points_ending(const std::string& path) { return check_ending(path, {".ply", ".xyz", ".pcd", ".drc"}); }

absl::Status save_points(const std::string& path, const client::Points& points, const client::DrcOptions& drc) {
  if (ending_of(path) != ".drc") return client::write_point_file(path, points);
  absl::StatusOr<std::string> bytes = client::make_drc(points, drc);
  if (!bytes.ok()) return bytes.status();
  return client::write_bytes(path, *bytes);
}

absl::StatusOr<client::Points> load_points(const std::string& path) {
  return ending_of(path) == ".drc" ? client::read_drc(path) : client::read_point_file(path);
}

absl::StatusOr<bool> holds_points(const std::string& path) {
  absl::StatusOr<client::InputFile> file = client::InputFile::open(path);
  if (!file.ok()) return file.status();
  const std::string ending = ending_of(path);
  if (ending == ".drc" || ending == ".xyz" || ending == ".pcd") return true;
  if (ending != ".ply") return false;
  std::string start(std::min(file->size(), kMaxPlyHeader), '\0');
  if (absl::Status status = file->read_at(0, start); !status.ok()) return status;
  return absl::StartsWith(start, "ply") && !ply_declares_faces(start);
}

}  // namespace curvecast::cli
