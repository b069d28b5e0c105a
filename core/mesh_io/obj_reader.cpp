#include "core/mesh_io/obj_reader.h"

#include <absl/strings/str_format.h>

#include <array>
#include <utility>
#include <vector>

#include "core/base/text_scanner.h"
#include "core/mesh_io/obj_materials.h"
#include "core/mesh_io/obj_shading.h"
#include "core/mesh_io/reading/mesh_reading.h"
#include "core/mesh_io/reading/texture_loader.h"
#include "core/mesh_io/text_colours.h"

namespace curvecast {
namespace {

class ObjReader {
 public:
  ObjReader(const MeshFile& file, const ExecutionContext& context)
      : file_(file), scanner_(file.text()), monitor_(context, file.bytes.size()) {}

  absl::StatusOr<PolygonSoup> read() {
    soup_.polygon_begin.push_back(0);
    while (!scanner_.at_end()) {
      if (!monitor_.tick(scanner_.offset())) return monitor_.status();
      scanner_.skip_blanks();
      const bool comment = scanner_.peek() == '#';
      const std::string_view keyword = comment ? std::string_view() : scanner_.word();
      absl::Status status;
      if (keyword == "v") {
        status = read_vertex();
      } else if (keyword == "f") {
        status = read_face();
      } else if (keyword == "vt") {
        status = read_texture_place();
      } else if (keyword == "vn") {
        read_normal();
      } else if (keyword == "s") {
        read_group();
      } else if (keyword == "usemtl") {
        material_ = materials_.use(scanner_.line_rest(), scanner_.line());
      } else if (keyword == "mtllib") {
        materials_.note_library(scanner_.line_rest(), scanner_.line());
      }
      if (!status.ok()) return status;
      comment ? scanner_.next_line() : skip_statement();
    }
    if (absl::Status status = check_forward_references(); !status.ok()) return status;
    if (absl::Status status = finish_uv(); !status.ok()) return status;
    soup_.crease_degrees = shading_.crease_angle(soup_);
    soup_.attributes.colours = colours_.take(soup_.positions.size());
    if (!soup_.attributes.material_of_face.empty()) {
      soup_.attributes.materials = materials_.resolve(file_, soup_.warnings);
    }
    return std::move(soup_);
  }

 private:
  // A face may come before its vertices: what it asks for is checked at the end. Only a new largest index is noted, because the
  // first face at fault always has one.
  struct ForwardReference {
    std::uint32_t index;
    std::size_t line;
  };

  void skip_blanks() {
    do {
      scanner_.skip_blanks();
    } while (scanner_.skip_continuation());
  }

  void skip_statement() {
    for (;;) {
      scanner_.skip_until('\\', '#');
      if (scanner_.peek() != '\\') break;
      if (!scanner_.skip_continuation()) scanner_.skip_char();
    }
    scanner_.next_line();
  }

  absl::Status read_vertex() {
    Vec3d p;
    for (int axis = 0; axis < 3; ++axis) {
      skip_blanks();
      if (!scanner_.number(p[axis])) return scanner_.expected("a coordinate of a vertex");
    }
    if (!is_finite(p)) return scanner_.error(kNotFinite);
    if (soup_.positions.size() == kMaxVertices) return scanner_.error(kTooManyVertices);
    read_colour();
    soup_.positions.push_back(p);
    return absl::OkStatus();
  }

  // Behind the coordinates: nothing, a weight, or red, green, blue and maybe alpha.
  void read_colour() {
    std::array<float, 4> values = {0, 0, 0, -1};
    int count = 0;
    double value = 0;
    for (skip_blanks(); count < 4 && scanner_.number(value); skip_blanks()) values[count++] = static_cast<float>(value);
    if (count >= 3) colours_.put(soup_.positions.size(), values);
  }

  absl::Status read_texture_place() {
    double u = 0, v = 0;
    skip_blanks();
    if (!scanner_.number(u)) return scanner_.expected("a texture coordinate");
    skip_blanks();
    scanner_.number(v);  // a texture of one dimension has none
    if (places_.size() == kMaxVertices) return scanner_.error(kTooManyVertices);
    places_.emplace_back(static_cast<float>(u), static_cast<float>(v));
    return absl::OkStatus();
  }

  // A normal that is not there, or none at all, is no reason to refuse the shape.
  void read_normal() {
    if (!shading_.is_open()) return;
    Vec3d n = Vec3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      skip_blanks();
      if (!scanner_.number(n[axis])) break;
    }
    shading_.add_normal(n);
  }

  void read_group() {
    std::int64_t group = 0;  // "off"
    skip_blanks();
    scanner_.integer(group);
    shading_.use_group(group);
  }

  absl::Status read_face() {
    for (skip_blanks(); !scanner_.at_line_end() && scanner_.peek() != '#'; skip_blanks()) {
      std::int64_t number = 0;
      std::int64_t place = 0, normal = 0;
      if (!scanner_.integer(number)) return scanner_.expected("a vertex index");
      if (!read_texture_and_normal(place, normal)) return scanner_.expected("a vertex index such as 7, 7/8, 7//9 or 7/8/9");
      if (number == 0) return scanner_.error("vertex index 0 is out of range (OBJ counts from 1, or from -1 backwards)");
      const auto vertices = static_cast<std::int64_t>(soup_.positions.size());
      const std::int64_t index = number > 0 ? number - 1 : vertices + number;
      if (index < 0 || index >= static_cast<std::int64_t>(kMaxVertices)) {
        return scanner_.error(index_out_of_range(number, soup_.positions.size()));
      }
      if (index >= vertices && (forward_.empty() || index > forward_.back().index)) {
        forward_.push_back({static_cast<std::uint32_t>(index), scanner_.line()});
      }
      if (place != 0) note_place(place);
      if (normal != 0) shading_.note_normal(soup_.indices.size(), normal);
      soup_.indices.push_back(static_cast<std::uint32_t>(index));
      if (!monitor_.tick(scanner_.offset())) return monitor_.status();
    }
    const std::size_t polygons = soup_.polygon_count();
    if (!close_polygon(soup_)) return scanner_.error(kTooManyCorners);
    if (!place_of_corner_.empty()) place_of_corner_.resize(soup_.indices.size(), kNoPlace);
    if (soup_.polygon_count() > polygons) shading_.note_polygon(polygons);
    if (soup_.polygon_count() == polygons || !materials_.any_used()) return absl::OkStatus();
    soup_.attributes.material_of_face.resize(polygons, MeshAttributes::kNoMaterial);
    soup_.attributes.material_of_face.push_back(material_);
    return absl::OkStatus();
  }

  // Behind a vertex index: nothing, /8, //9 or /8/9; 8 is the texture coordinate's number, 9 the normal's, 0 for none. The
  // numbers themselves may be missing: exporters write "7//" as well.
  bool read_texture_and_normal(std::int64_t& place, std::int64_t& normal) {
    for (int part = 0; part < 2 && scanner_.peek() == '/'; ++part) {
      scanner_.skip_char();
      if (scanner_.integer(part == 0 ? place : normal)) continue;
      if (scanner_.peek() == '-') scanner_.skip_char();
      while (scanner_.peek() >= '0' && scanner_.peek() <= '9') scanner_.skip_char();
    }
    const char c = scanner_.peek();
    return scanner_.at_line_end() || c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\\';
  }

  // Of the corner that comes next. Numbers beyond what can be are caught when all texture coordinates are known.
  void note_place(std::int64_t number) {
    const std::int64_t index = number > 0 ? number - 1 : static_cast<std::int64_t>(places_.size()) + number;
    const bool possible = index >= 0 && index < static_cast<std::int64_t>(kNoPlace);
    place_of_corner_.resize(soup_.indices.size(), kNoPlace);
    place_of_corner_.push_back(possible ? static_cast<std::uint32_t>(index) : kNoPlace);
    if (!possible) ++lost_places_;
  }

  // Texture coordinates that are not there are a reason to warn only: the shape is whole without them.
  absl::Status finish_uv() {
    if (places_.empty()) return absl::OkStatus();
    std::vector<Vec2f>& uv = soup_.attributes.uv;
    uv.assign(place_of_corner_.empty() ? 0 : soup_.indices.size(), Vec2f::Zero());
    for (std::size_t i = 0; i < place_of_corner_.size(); ++i) {
      if (place_of_corner_[i] < places_.size()) {
        uv[i] = places_[place_of_corner_[i]];
      } else if (place_of_corner_[i] != kNoPlace) {
        ++lost_places_;
      }
    }
    if (lost_places_ > 0) {
      add_warning(soup_.warnings,
                  absl::StrFormat("%d corners have texture coordinates that are not in the file (it has %d); they become 0 0.",
                                  lost_places_, places_.size()));
    }
    return monitor_.status();
  }

  absl::Status check_forward_references() {
    for (const ForwardReference& reference : forward_) {
      if (reference.index < soup_.positions.size()) continue;
      const std::string what = index_out_of_range(std::int64_t{reference.index} + 1, soup_.positions.size());
      return absl::InvalidArgumentError(absl::StrFormat("line %d: %s", reference.line, what));
    }
    return absl::OkStatus();
  }

  static constexpr std::uint32_t kNoPlace = UINT32_MAX;

  const MeshFile& file_;
  TextScanner scanner_;
  ReadMonitor monitor_;
  PolygonSoup soup_;
  std::vector<ForwardReference> forward_;
  std::vector<Vec2f> places_;                   // all vt
  std::vector<std::uint32_t> place_of_corner_;  // into places_; of the corners up to the last that has one
  std::uint64_t lost_places_ = 0;
  TextColours colours_;
  ObjMaterials materials_;
  ObjShading shading_;
  std::uint32_t material_ = MeshAttributes::kNoMaterial;  // of the faces to come
};

}  // namespace

absl::StatusOr<PolygonSoup> read_obj(const MeshFile& file, const ExecutionContext& context) {
  return ObjReader(file, context).read();
}

}  // namespace curvecast
