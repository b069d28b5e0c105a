// Point sets as files of many kinds.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "proto/formats/point_columns.h"

namespace curvecast::server {

struct PointFileKind {
  std::string_view ending;  // "ply"
  std::string_view type;    // as in Content-Type
  bool is_ranked;           // whether its points come in order of rank, where they have ranks
};

/// Returns the kind with this ending; null: there is none.
const PointFileKind* find_point_file_kind(std::string_view ending);
/// Returns the endings of all kinds, for messages.
std::string point_file_endings();

/// What an ending leaves open.
struct PointFileTerms {
  bool splats = false;      // .ply and .glb: flat Gaussians
  bool quantises = true;    // .glb: see formats::GlbOptions
  bool compresses = false;  // .glb
  int position_bits = 16;   // .drc: 1 to 30, of the longest side of the points' box
  int normal_bits = 10;     // .drc: 2 to 30
};

/// Points that come block by block, as RawPoints.
class GatheredPoints {
 public:
  /// InvalidArgument: blocks that do not go together.
  absl::Status append(const v1::PointBlock& block);
  std::size_t size() const { return positions_.size(); }
  /// Returns them, as long as nothing is appended.
  formats::PointColumns columns() const;

 private:
  struct Scalars {
    std::string name;
    std::vector<float> values;
  };

  std::array<double, 3> origin_{};
  std::vector<std::array<float, 3>> positions_, normals_, directions_;
  std::vector<float> radii_;
  std::vector<std::array<std::uint8_t, 3>> colours_;
  std::vector<std::array<float, 2>> curvatures_, barycentric_;
  std::vector<std::uint32_t> ranks_, faces_;
  std::vector<Scalars> scalars_;
};

struct PointFile {
  std::string bytes;
  std::vector<std::pair<std::string, std::string>> header = {};  // what the file has no place for, as fields of an answer
};

/// Makes a file. InvalidArgument: points that the format cannot hold.
absl::StatusOr<PointFile> make_point_file(const formats::PointColumns& columns, const PointFileKind& kind,
                                          const PointFileTerms& terms);

}  // namespace curvecast::server
