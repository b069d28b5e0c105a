#include "client/cli/points_io.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <new>
#include <utility>
#include <vector>

#include "client/cli/common.h"
#include "client/lib/file_bytes.h"
#include "client/lib/point_file.h"
#include "proto/formats/glb_splats.h"
#include "proto/formats/las.h"
#include "proto/formats/npy.h"
#include "proto/formats/splat_ply.h"
#include "proto/formats/spz.h"

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

absl::StatusOr<std::string> make_ranked(const std::string& ending, const formats::PointColumns& columns,
                                        const SaveOptions& options) {
  if (ending == ".npy") return formats::make_npy(columns);
  if (ending == ".npz") return formats::make_npz(columns);
  if (ending == ".las") return formats::make_las(columns);
  if (ending == ".spz") return formats::make_spz(columns);
  if (ending == ".ply") return formats::make_splat_ply(columns);
  if (ending == ".glb") return options.splats ? formats::make_glb_splats(columns) : formats::make_glb(columns, options.glb);
  return absl::InternalError("unknown point format");
}

absl::Status save_ranked(const std::string& path, const client::Points& points, const SaveOptions& options) {
  try {
    const absl::StatusOr<std::string> bytes = make_ranked(ending_of(path), columns_of(points), options);
    if (bytes.ok()) return client::write_bytes(path, *bytes);
    return absl::Status(bytes.status().code(), absl::StrCat(path, ": ", bytes.status().message()));
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory to write the points"));
  }
}

}  // namespace

formats::PointColumns columns_of(const client::Points& points) {
  formats::PointColumns columns{.origin = points.origin,
                                .positions = points.positions,
                                .normals = points.normals,
                                .radii = points.radii,
                                .colours = points.colours,
                                .curvatures = points.curvatures,
                                .ranks = points.ranks,
                                .faces = points.faces,
                                .barycentric = points.barycentric,
                                .directions = points.directions};
  for (const auto& [name, values] : points.scalars) columns.scalars.push_back({name, values});
  return columns;
}

bool holds_splats(const std::string& path) { return check_ending(path, {".ply", ".glb", ".spz"}).ok(); }

bool is_in_order_of_rank(const std::string& path, bool splats) {
  return splats ? holds_splats(path) : check_ending(path, {".npy", ".npz", ".glb", ".spz", ".las"}).ok();
}

absl::Status check_points_ending(const std::string& path) { return check_ending(path, {".ply", ".xyz", ".pcd", ".drc"}); }

absl::Status check_output_ending(const std::string& path) {
  return check_ending(path, {".ply", ".xyz", ".pcd", ".drc", ".npy", ".npz", ".glb", ".spz", ".las"});
}

absl::Status save_points(const std::string& path, const client::Points& points, const SaveOptions& options) {
  if (options.splats && !holds_splats(path))
    return absl::InvalidArgumentError(path + ": splats are written to .ply, .glb and .spz");
  if (is_in_order_of_rank(path, options.splats)) return save_ranked(path, points, options);
  if (ending_of(path) != ".drc") return client::write_point_file(path, points);
  absl::StatusOr<std::string> bytes = client::make_drc(points, options.drc);
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
