#include "server/web/resources/point_file.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/codec/draco_codec.h"
#include "proto/formats/glb_points.h"
#include "proto/formats/glb_splats.h"
#include "proto/formats/las.h"
#include "proto/formats/npy.h"
#include "proto/formats/ply.h"
#include "proto/formats/points_json.h"
#include "proto/formats/splat_ply.h"
#include "proto/formats/spz.h"

namespace curvecast::server {
namespace {

constexpr char kBytes[] = "application/octet-stream";

constexpr std::array<PointFileKind, 8> kKinds = {{{"ply", kBytes, false},
                                                  {"npz", "application/zip", true},
                                                  {"npy", kBytes, true},
                                                  {"glb", "model/gltf-binary", true},
                                                  {"spz", kBytes, true},
                                                  {"las", "application/vnd.las", true},
                                                  {"drc", kBytes, false},
                                                  {"json", "application/json", false}}};

template <typename T>
void append_values(const std::string& bytes, std::vector<T>& values) {
  const std::size_t before = values.size();
  values.resize(before + bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data() + before, bytes.data(), (values.size() - before) * sizeof(T));
}

/// Draco's lattice is of floats around zero.
absl::StatusOr<PointFile> make_drc(const formats::PointColumns& columns, const PointFileTerms& terms) {
  PointSet points;
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max()), high = -low;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    points.positions.emplace_back(static_cast<float>(columns.absolute(i, 0)), static_cast<float>(columns.absolute(i, 1)),
                                  static_cast<float>(columns.absolute(i, 2)));
    low = low.cwiseMin(points.positions.back());
    high = high.cwiseMax(points.positions.back());
    points.normals.emplace_back(columns.normals[i][0], columns.normals[i][1], columns.normals[i][2]);
    points.radii.push_back(columns.radii[i]);
    if (columns.colours.empty()) continue;
    const auto& [red, green, blue] = columns.colours[i];
    points.colours.push_back({red, green, blue, 255});
  }
  const double size = (high - low).cast<double>().maxCoeff();
  const DracoOptions options{.position_bits = terms.position_bits,
                             .normal_bits = terms.normal_bits,
                             .box_min = low.cast<double>(),
                             .box_size = size > 0 ? size : 1};
  float least = 0, largest = 0;
  absl::StatusOr<std::string> bytes = encode_draco(points, options, &least, &largest);
  if (!bytes.ok()) return bytes.status();
  return PointFile{*std::move(bytes), {{"Curvecast-Radius-Range", absl::StrCat(least, " ", largest)}}};
}

absl::StatusOr<std::string> make_bytes(const formats::PointColumns& columns, const PointFileKind& kind,
                                       const PointFileTerms& terms) {
  if (kind.ending == "ply") return terms.splats ? formats::make_splat_ply(columns) : formats::make_ply(columns);
  if (kind.ending == "npz") return formats::make_npz(columns);
  if (kind.ending == "npy") return formats::make_npy(columns);
  if (kind.ending == "spz") return formats::make_spz(columns);
  if (kind.ending == "las") return formats::make_las(columns);
  if (kind.ending == "json") return formats::make_points_json(columns);
  if (terms.splats) return formats::make_glb_splats(columns);
  return formats::make_glb(columns, {.quantise = terms.quantises, .compress = terms.compresses});
}

}  // namespace

const PointFileKind* find_point_file_kind(std::string_view ending) {
  const auto found = std::find_if(kKinds.begin(), kKinds.end(), [&](const PointFileKind& kind) { return kind.ending == ending; });
  return found == kKinds.end() ? nullptr : &*found;
}

std::string point_file_endings() {
  std::string all;
  for (const PointFileKind& kind : kKinds) absl::StrAppend(&all, all.empty() ? "" : ", ", std::string(kind.ending));
  return all;
}

absl::Status GatheredPoints::append(const v1::PointBlock& block) {
  const std::array<double, 3> origin = {block.origin().x(), block.origin().y(), block.origin().z()};
  if (!positions_.empty() && origin != origin_) return absl::InternalError("blocks of points have different origins");
  origin_ = origin;
  const v1::RawPoints& raw = block.raw();
  const v1::PointAttributes& more = block.attributes();
  if (scalars_.empty() && positions_.empty()) {
    for (const v1::ScalarValues& column : more.scalars()) scalars_.push_back({column.name(), {}});
  }
  if (more.scalars_size() != static_cast<int>(scalars_.size())) {
    return absl::InternalError("blocks of points have different columns");
  }
  append_values(raw.positions(), positions_);
  append_values(raw.normals(), normals_);
  append_values(raw.radii(), radii_);
  append_values(raw.colours(), colours_);
  append_values(more.curvatures(), curvatures_);
  append_values(more.ranks(), ranks_);
  append_values(more.faces(), faces_);
  append_values(more.barycentric(), barycentric_);
  append_values(more.directions(), directions_);
  for (std::size_t s = 0; s < scalars_.size(); ++s) append_values(more.scalars(static_cast<int>(s)).values(), scalars_[s].values);
  return absl::OkStatus();
}

formats::PointColumns GatheredPoints::columns() const {
  formats::PointColumns columns{.origin = origin_,
                                .positions = positions_,
                                .normals = normals_,
                                .radii = radii_,
                                .colours = colours_,
                                .curvatures = curvatures_,
                                .ranks = ranks_,
                                .faces = faces_,
                                .barycentric = barycentric_,
                                .directions = directions_};
  for (const Scalars& column : scalars_) columns.scalars.push_back({column.name, column.values});
  return columns;
}

absl::StatusOr<PointFile> make_point_file(const formats::PointColumns& columns, const PointFileKind& kind,
                                          const PointFileTerms& terms) {
  if (absl::Status status = formats::check_columns(columns); !status.ok()) return status;
  if (kind.ending == "drc") return make_drc(columns, terms);
  absl::StatusOr<std::string> bytes = make_bytes(columns, kind, terms);
  if (!bytes.ok()) return bytes.status();
  return PointFile{*std::move(bytes)};
}

}  // namespace curvecast::server
