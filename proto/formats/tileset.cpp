// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/tileset.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <utility>

#include "proto/formats/prefix_distance.h"

namespace curvecast::formats {
namespace {

using nlohmann::json;

constexpr int kMostLevels = 12;
constexpr std::size_t kLeastShare = 16;   // a part of root_points: on average no level's tiles have fewer points than that
constexpr double kLatticeSteps = 65'535;  // as GlbOptions::quantise has them

/// The axes of a tileset: viewers turn the second axis of a tile's glTF into the third one of the set.
std::array<double, 3> to_set(const std::array<double, 3>& p) { return {p[0], -p[2], p[1]}; }

/// Makes `all` hold another box, too; nothing: it holds none yet.
void grow(std::optional<Box>& all, const Box& more) {
  if (!all) all = more;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all->low[axis] = std::min(all->low[axis], more.low[axis]);
    all->high[axis] = std::max(all->high[axis], more.high[axis]);
  }
}

/// One tile, made of the points [begin, end) of the curve order.
struct Tile {
  std::size_t begin = 0, end = 0;
  std::vector<std::uint32_t> own;  // the points that it shows
  std::optional<Box> box;          // of those and all below; nothing: there are none
  float error = 0;
};

class Tileset {
 public:
  Tileset(const PointColumns& columns, const TilesetOptions& options, const std::function<absl::Status(TileFile file)>& emit)
      : columns_(columns), options_(options), emit_(emit) {}

  absl::Status make() {
    divide();
    // Level by level, so that `emit` may end the work before all distances are known.
    for (std::size_t level = levels_.size(); level-- > 0;) {
      find_boxes_and_errors(level);
      for (std::size_t t = 0; t < levels_[level].size(); ++t) {
        if (levels_[level][t].own.empty()) continue;
        absl::Status status = emit_content(level, t);
        if (!status.ok()) return status;
      }
    }
    for (std::size_t level = levels_.size(); level-- > 0;) {
      for (std::size_t t = 0; t < levels_[level].size() && has_file(level); ++t) {
        if (!has_below(level, t)) continue;
        absl::Status status = emit_({json_name(level, t), below(level, t).dump()});
        if (!status.ok()) return status;
      }
    }
    return emit_({kTilesetName, whole().dump(1)});
  }

 private:
  void divide() {
    const std::size_t n = columns_.size();
    const std::uint32_t last = *std::max_element(columns_.ranks.begin(), columns_.ranks.end());
    std::uint64_t prefix = options_.root_points;
    for (int level = 0;; ++level, prefix *= 4) {
      const std::size_t count = std::size_t{1} << 2 * level;
      std::vector<Tile>& tiles = levels_.emplace_back(count);
      for (std::size_t t = 0; t < count; ++t) tiles[t].begin = n * t / count, tiles[t].end = n * (t + 1) / count;
      // Where the density is far from even, ranks grow without end. Parts so small had better be shown as a whole.
      const bool is_finest = kLeastShare * n < 4 * count * std::size_t{options_.root_points};
      if (prefix > last || is_finest || level + 1 == kMostLevels) break;
    }
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      for (Tile& tile : levels_[level]) {
        for (std::size_t i = tile.begin; i < tile.end; ++i) {
          if (level_of(columns_.ranks[i]) == level) tile.own.push_back(static_cast<std::uint32_t>(i));
        }
      }
    }
  }

  /// The first level that shows a rank; the last level all that are left.
  std::size_t level_of(std::uint32_t rank) const {
    std::size_t level = 0;
    for (std::uint64_t prefix = options_.root_points; rank >= prefix && level + 1 < levels_.size(); prefix *= 4) ++level;
    return level;
  }

  void find_boxes_and_errors(std::size_t level) {
    std::vector<float> distances;
    if (level + 1 < levels_.size()) {
      distances = distances_to_prefix(columns_.positions, columns_.ranks, std::uint64_t{options_.root_points} << 2 * level);
    }
    for (Tile& tile : levels_[level]) {
      for (std::size_t i = tile.begin; i < tile.end; ++i) {
        if (level_of(columns_.ranks[i]) < level) continue;
        const std::array<float, 3>& p = columns_.positions[i];
        grow(tile.box, {p, p});
        if (!distances.empty()) tile.error = std::max(tile.error, distances[i]);
      }
    }
  }

  absl::Status emit_content(std::size_t level, std::size_t t) {
    const std::vector<std::uint32_t>& own = levels_[level][t].own;
    const auto gather = [&own](const auto& column, auto& out) {
      if (column.empty()) return;
      out.reserve(own.size());
      for (const std::uint32_t i : own) out.push_back(column[i]);
    };
    std::vector<std::array<float, 3>> positions, normals;
    std::vector<std::array<std::uint8_t, 3>> colours;
    gather(columns_.positions, positions);
    gather(columns_.normals, normals);
    gather(columns_.colours, colours);
    // Along the curve neighbours follow each other, which takes fewer bytes than the order of ranks: a tile is shown as a whole.
    absl::StatusOr<std::string> bytes =
        make_glb({.origin = columns_.origin, .positions = positions, .normals = normals, .colours = colours}, options_.content);
    if (!bytes.ok()) return bytes.status();
    return emit_({content_name(level, t), *std::move(bytes)});
  }

  static std::string content_name(std::size_t level, std::size_t t) { return absl::StrCat(level, "-", t, ".glb"); }
  static std::string json_name(std::size_t level, std::size_t t) { return absl::StrCat(level, "-", t, ".json"); }

  /// Whether what lies below the tiles of a level has files of its own.
  bool has_file(std::size_t level) const {
    return (level + 1) % static_cast<std::size_t>(options_.json_levels) == 0 && level + 1 < levels_.size();
  }
  bool has_below(std::size_t level, std::size_t t) const {
    if (level + 1 >= levels_.size()) return false;
    const auto is_there = [](const Tile& tile) { return tile.box.has_value(); };
    const auto first = levels_[level + 1].begin() + static_cast<std::ptrdiff_t>(4 * t);
    return std::any_of(first, first + 4, is_there);
  }

  json volume(const Box& box) const {
    // Points are rounded to a lattice along the longest side of their own tile's box, which is no longer than this one's.
    const double rounding = options_.content.quantise ? 0.5 * box.extent() / kLatticeSteps : 0;
    std::array<double, 3> middle, half;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = columns_.origin[axis] + double{box.low[axis]}, high = columns_.origin[axis] + double{box.high[axis]};
      middle[axis] = 0.5 * (low + high);
      half[axis] = 0.5 * (high - low) + rounding;
    }
    const std::array<double, 3> centre = to_set(middle);
    return {{"box", {centre[0], centre[1], centre[2], half[0], 0, 0, 0, half[2], 0, 0, 0, half[1]}}};
  }

  /// `folder`: of the files that it names.
  json describe(std::size_t level, std::size_t t, const std::string& folder) const {
    const Tile& tile = levels_[level][t];
    json out = {{"boundingVolume", volume(*tile.box)}, {"geometricError", tile.error}};
    if (level == 0) out["refine"] = "ADD";
    if (!tile.own.empty()) out["content"] = {{"uri", folder + content_name(level, t)}};
    if (!has_below(level, t)) return out;
    if (has_file(level)) {
      out["children"] = json::array({{{"boundingVolume", below_volume(level, t)},
                                      {"geometricError", tile.error},
                                      {"content", {{"uri", folder + json_name(level, t)}}}}});
    } else {
      out["children"] = children(level, t, folder);
    }
    return out;
  }

  json children(std::size_t level, std::size_t t, const std::string& folder) const {
    json out = json::array();
    for (std::size_t child = 4 * t; child < 4 * t + 4; ++child) {
      if (levels_[level + 1][child].box) out.push_back(describe(level + 1, child, folder));
    }
    return out;
  }

  json below_volume(std::size_t level, std::size_t t) const {
    std::optional<Box> all;
    for (std::size_t child = 4 * t; child < 4 * t + 4; ++child) {
      if (const std::optional<Box>& box = levels_[level + 1][child].box) grow(all, *box);
    }
    return volume(*all);
  }

  /// The file of what lies below a tile: a tile without content that holds its children.
  json below(std::size_t level, std::size_t t) const {
    const float error = levels_[level][t].error;
    return {{"asset", {{"version", "1.1"}}},
            {"geometricError", error},
            {"root",
             {{"boundingVolume", below_volume(level, t)},
              {"geometricError", error},
              {"refine", "ADD"},
              {"children", children(level, t, "")}}}};
  }

  json whole() const {
    json root = describe(0, 0, options_.folder);
    // Without a turn the second axis of the mesh points upwards.
    if (options_.z_up) root["transform"] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1};
    const double diagonal = std::sqrt(3.0) * levels_[0][0].box->extent();
    return {{"asset", {{"version", "1.1"}, {"generator", "Curvecast"}}},
            {"geometricError", diagonal},
            {"root", std::move(root)},
            {"extras", {{"points", columns_.size()}, {"levels", levels_.size()}, {"rootPoints", options_.root_points}}}};
  }

  const PointColumns& columns_;
  const TilesetOptions& options_;
  const std::function<absl::Status(TileFile file)>& emit_;
  std::vector<std::vector<Tile>> levels_;
};

absl::Status check(const PointColumns& columns, const TilesetOptions& options) {
  if (absl::Status status = check_columns(columns); !status.ok()) return status;
  if (columns.size() == 0) return absl::InvalidArgumentError("there are no points to make tiles of");
  if (columns.ranks.empty()) return absl::InvalidArgumentError("tiles are made of ranked points, and these have no ranks");
  if (options.root_points < 1 || options.json_levels < 1) {
    return absl::InvalidArgumentError(absl::StrFormat("root_points = %d and json_levels = %d: both must be 1 or more",
                                                      options.root_points, options.json_levels));
  }
  std::vector<std::uint32_t> sorted(columns.ranks.begin(), columns.ranks.end());
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end()) {
    return absl::InvalidArgumentError(absl::StrCat("two points have the rank ", *twice));
  }
  if (sorted.front() >= options.root_points) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the least rank is %d: the root, of %d, would be empty", sorted.front(), options.root_points));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status make_tileset(const PointColumns& columns, const TilesetOptions& options,
                          const std::function<absl::Status(TileFile file)>& emit) {
  if (absl::Status status = check(columns, options); !status.ok()) return status;
  return Tileset(columns, options, emit).make();
}

bool is_tile_name(std::string_view name) {
  static const std::regex tile("[0-9]{1,2}-[0-9]{1,8}[.](glb|json)");
  return std::regex_match(name.begin(), name.end(), tile);
}

}  // namespace curvecast::formats
