#include "core/mesh_io/ply_reader.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/base/text_scanner.h"
#include "core/mesh_io/ply_columns.h"
#include "core/mesh_io/ply_header.h"
#include "core/mesh_io/ply_plain_faces.h"
#include "core/mesh_io/ply_source.h"
#include "core/mesh_io/reading/companion_name.h"
#include "core/mesh_io/reading/mesh_reading.h"
#include "core/mesh_io/reading/texture_loader.h"

namespace curvecast {
namespace {

enum class Role { kVertices, kPolygons, kStrips, kOther };

Role role_of(const PlyElement& element) {
  if (element.name == "vertex") return Role::kVertices;
  if (element.name == "face") return Role::kPolygons;
  if (element.name == "tristrips") return Role::kStrips;
  return Role::kOther;
}

// The list of vertex indices among the properties; PlyFaceLayout::kNotThere without one.
std::size_t find_index_list(const PlyElement& element) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    const bool name_fits = property.name == "vertex_indices" || property.name == "vertex_index";
    if (name_fits && property.is_list && is_integer(property.type)) return i;
  }
  return PlyFaceLayout::kNotThere;
}

// The bytes of each element, when they are the same for all (no lists).
std::optional<std::size_t> fixed_size(const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.is_list) return std::nullopt;
    bytes += ply_type_bytes(property.type);
  }
  return bytes;
}

template <class Source>
class PlyBodyReader {
 public:
  PlyBodyReader(std::string_view bytes, const PlyHeader& header, const ExecutionContext& context)
      : header_(header), source_(bytes, header), monitor_(context, bytes.size()) {}

  absl::StatusOr<PolygonSoup> read(const MeshFile& file) {
    soup_.polygon_begin.push_back(0);
    std::size_t elements_needed = 0;
    for (std::size_t i = 0; i < header_.elements.size(); ++i) {
      const PlyElement& element = header_.elements[i];
      if (role_of(element) == Role::kOther) continue;
      elements_needed = i + 1;
      if (role_of(element) != Role::kVertices) continue;
      if (vertex_count_) return absl::InvalidArgumentError("the header has more than one element 'vertex'");
      vertex_count_ = element.count;
    }
    if (!vertex_count_) return absl::InvalidArgumentError("the header has no element 'vertex'");
    if (*vertex_count_ > kMaxVertices) return absl::InvalidArgumentError(kTooManyVertices);
    for (std::size_t i = 0; i < elements_needed; ++i) {
      const PlyElement& element = header_.elements[i];
      if (element.count == 0 || element.properties.empty()) continue;  // no bytes
      if (absl::Status status = read_element(element); !status.ok()) return status;
    }
    if (soup_.positions.size() != *vertex_count_) {
      return absl::InvalidArgumentError("the element 'vertex' has no properties x, y and z");
    }
    TextureLoader textures(file, soup_.warnings);
    finish_attributes(textures);
    return std::move(soup_);
  }

 private:
  static constexpr bool kBinary = !std::is_same_v<Source, PlyTextSource>;

  absl::Status read_element(const PlyElement& element) {
    if (const std::uint64_t fit = source_.capacity(element); element.count > fit) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s %d: the file ends here at the latest, but its header claims %d of these", printable(element.name),
                          fit, element.count));
    }
    switch (role_of(element)) {
      case Role::kVertices:
        return read_vertices(element);
      case Role::kPolygons:
      case Role::kStrips:
        return read_faces(element);
      case Role::kOther:
        break;
    }
    return skip_element(element);
  }

  absl::Status skip_element(const PlyElement& element) {
    if constexpr (kBinary) {
      if (const std::optional<std::size_t> bytes = fixed_size(element)) {
        source_.advance(element.count * *bytes);  // within the file: see the capacity
        return absl::OkStatus();
      }
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!monitor_.tick(source_.offset())) return monitor_.status();
      for (const PlyProperty& property : element.properties) {
        if (absl::Status status = skip_property(element, property, i); !status.ok()) return status;
      }
    }
    return absl::OkStatus();
  }

  absl::Status skip_property(const PlyElement& element, const PlyProperty& property, std::uint64_t number) {
    std::int64_t length = 1;
    if (property.is_list) {
      if (absl::Status status = read_length(element, property, number, length); !status.ok()) return status;
    }
    return source_.skip(property.type, static_cast<std::uint64_t>(length)) ? absl::OkStatus() : source_.missing(element, number);
  }

  absl::Status read_length(const PlyElement& element, const PlyProperty& list, std::uint64_t number, std::int64_t& length) {
    if (!source_.integer(list.count_type, length)) return source_.missing(element, number);
    if (length < 0) return source_.error(element.name, number, absl::StrFormat("a list has the negative length %d", length));
    return absl::OkStatus();
  }

  // ------------------------------------------------------------------------------------------------------------ vertices

  absl::Status read_vertices(const PlyElement& element) {
    const std::vector<PlyColumn> columns = vertex_columns(element, soup_, vertex_uv_);
    if (columns.empty()) {
      const auto is_there = [&](std::string_view name) {
        return std::any_of(element.properties.begin(), element.properties.end(),
                           [&](const PlyProperty& property) { return property.name == name && !property.is_list; });
      };
      const char* const missing = !is_there("x") ? "x" : !is_there("y") ? "y" : "z";
      return absl::InvalidArgumentError(absl::StrFormat("the element 'vertex' has no property '%s'", missing));
    }
    if constexpr (kBinary) {
      if (const std::optional<std::size_t> stride = fixed_size(element)) return read_fixed_vertices(element, columns, *stride);
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!monitor_.tick(source_.offset())) return monitor_.status();
      std::size_t next = 0;
      for (std::size_t j = 0; j < element.properties.size(); ++j) {
        const bool wanted = next < columns.size() && columns[next].property == j;
        if (absl::Status status = read_property(element, j, i, wanted ? &columns[next] : nullptr, i); !status.ok()) return status;
        next += wanted;
      }
      if (!is_finite(soup_.positions[i])) return source_.error(element.name, i, kNotFinite);
    }
    return absl::OkStatus();
  }

  // Into place `slot` of the column; nowhere without one.
  absl::Status read_property(const PlyElement& element, std::size_t property, std::uint64_t number, const PlyColumn* column,
                             std::size_t slot) {
    if (column == nullptr) return skip_property(element, element.properties[property], number);
    double value = 0;
    if (!source_.real(column->type, value)) return source_.missing(element, number);
    put(*column, slot, value);
    return absl::OkStatus();
  }

  // Column by column, in blocks that stay in the cache meanwhile.
  absl::Status read_fixed_vertices(const PlyElement& element, const std::vector<PlyColumn>& columns, std::size_t stride) {
    constexpr std::size_t kBlock = 1024;
    for (std::size_t first = 0; first < element.count; first += kBlock) {
      if (!monitor_.tick(source_.offset(), kBlock)) return monitor_.status();
      const std::size_t count = std::min<std::size_t>(kBlock, element.count - first);
      for (const PlyColumn& column : columns) copy_column<Source>(column, source_.data(), stride, first, count);
      const Vec3d* const out = soup_.positions.data() + first;
      bool finite = true;
      for (std::size_t i = 0; i < count; ++i) finite &= is_finite(out[i]);
      if (!finite) {
        const Vec3d* const bad = std::find_if_not(out, out + count, is_finite);
        return source_.error(element.name, first + static_cast<std::size_t>(bad - out), kNotFinite);
      }
      source_.advance(count * stride);
    }
    return absl::OkStatus();
  }

  // --------------------------------------------------------------------------------------------------------------- faces

  absl::Status read_faces(const PlyElement& element) {
    const std::size_t list = find_index_list(element);
    if (list == PlyFaceLayout::kNotThere) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the element '%s' has no list 'vertex_indices' (or 'vertex_index') of integers", element.name));
    }
    const bool strips = role_of(element) == Role::kStrips;
    if (!strips) {
      grow(soup_.polygon_begin, soup_.polygon_begin.size() + element.count);
      grow(soup_.indices, soup_.indices.size() + std::min<std::uint64_t>(3 * element.count, source_.scalars_left()));
    }
    PlyFaceLayout layout{.indices = list};
    if (!strips) layout = {list, find_texcoord(element), face_columns(element, soup_, texture_numbers_)};
    PlyPlainFaces plain;
    if (kBinary && !strips) plain = PlyPlainFaces(element, layout, *vertex_count_);
    for (std::uint64_t i = 0; i < element.count;) {
      std::size_t triangles = 0;
      if constexpr (kBinary) triangles = plain.read(source_, soup_, element.count - i);
      if (!monitor_.tick(source_.offset(), triangles + 1)) return monitor_.status();
      i += triangles;
      if (triangles > 0) continue;
      if (absl::Status status = read_face(element, layout, strips, i); !status.ok()) return status;
      ++i;
    }
    return absl::OkStatus();
  }

  static std::size_t find_texcoord(const PlyElement& element) {
    for (std::size_t j = 0; j < element.properties.size(); ++j) {
      if (element.properties[j].name == "texcoord" && element.properties[j].is_list) return j;
    }
    return PlyFaceLayout::kNotThere;
  }

  absl::Status read_face(const PlyElement& element, const PlyFaceLayout& layout, bool strips, std::uint64_t number) {
    const std::size_t slot = soup_.polygon_count();  // those of too few corners leave it to the next
    std::size_t next = 0;
    face_uv_.clear();
    for (std::size_t j = 0; j < element.properties.size(); ++j) {
      const PlyProperty& property = element.properties[j];
      absl::Status status;
      if (j == layout.indices) {
        status = strips ? read_strips(element, property, number) : read_polygon(element, property, number);
      } else if (j == layout.texcoord) {
        status = read_texcoord(element, property, number);
      } else {
        const bool wanted = next < layout.columns.size() && layout.columns[next].property == j;
        status = read_property(element, j, number, wanted ? &layout.columns[next] : nullptr, slot);
        next += wanted;
      }
      if (!status.ok()) return status;
    }
    if (soup_.polygon_count() > slot && !face_uv_.empty()) append_uv(soup_, soup_.polygon_begin[slot], face_uv_);
    return absl::OkStatus();
  }

  absl::Status read_texcoord(const PlyElement& element, const PlyProperty& list, std::uint64_t number) {
    std::int64_t length = 0;
    if (absl::Status status = read_length(element, list, number, length); !status.ok()) return status;
    double value[2] = {0, 0};
    for (std::int64_t i = 0; i < length; ++i) {
      if (!source_.real(list.type, value[i % 2])) return source_.missing(element, number);
      if (i % 2 == 1) face_uv_.emplace_back(static_cast<float>(value[0]), static_cast<float>(value[1]));
      if (!monitor_.tick(source_.offset())) return monitor_.status();
    }
    return absl::OkStatus();
  }

  absl::Status read_polygon(const PlyElement& element, const PlyProperty& list, std::uint64_t number) {
    std::int64_t length = 0;
    if (absl::Status status = read_length(element, list, number, length); !status.ok()) return status;
    for (std::int64_t i = 0; i < length; ++i) {
      std::int64_t index = 0;
      if (!source_.integer(list.type, index)) return source_.missing(element, number);
      if (!in_range(index)) return source_.error(element.name, number, index_out_of_range(index, *vertex_count_));
      soup_.indices.push_back(static_cast<std::uint32_t>(index));
      if (!monitor_.tick(source_.offset())) return monitor_.status();
    }
    return close_polygon(soup_) ? absl::OkStatus() : absl::InvalidArgumentError(kTooManyCorners);
  }

  // Triangle strips in a row, each ended by -1 (the largest value of an unsigned type). Every second triangle of a strip runs the
  // other way round; one with a repeated corner only steers the strip.
  absl::Status read_strips(const PlyElement& element, const PlyProperty& list, std::uint64_t number) {
    std::int64_t length = 0;
    if (absl::Status status = read_length(element, list, number, length); !status.ok()) return status;
    const std::int64_t end_mark = list.type == PlyType::kUint32 ? std::int64_t{UINT32_MAX} : -1;
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint64_t place = 0;  // within the strip
    for (std::int64_t i = 0; i < length; ++i) {
      if (!monitor_.tick(source_.offset())) return monitor_.status();
      std::int64_t index = 0;
      if (!source_.integer(list.type, index)) return source_.missing(element, number);
      if (index == end_mark) {
        place = 0;
        continue;
      }
      if (!in_range(index)) return source_.error(element.name, number, index_out_of_range(index, *vertex_count_));
      const auto c = static_cast<std::uint32_t>(index);
      if (place >= 2 && a != b && b != c && c != a) {
        const bool flipped = place % 2 != 0;
        soup_.indices.insert(soup_.indices.end(), {flipped ? b : a, flipped ? a : b, c});
        if (!close_polygon(soup_)) return absl::InvalidArgumentError(kTooManyCorners);
      }
      a = b;
      b = c;
      ++place;
    }
    return absl::OkStatus();
  }

  bool in_range(std::int64_t index) const { return index >= 0 && static_cast<std::uint64_t>(index) < *vertex_count_; }

  // What was noted on the way, and what some polygons lack, as attributes of all.
  void finish_attributes(TextureLoader& textures) {
    MeshAttributes& attributes = soup_.attributes;
    if (!attributes.uv.empty()) {
      attributes.uv.resize(soup_.indices.size(), Vec2f::Zero());
    } else if (!vertex_uv_.empty()) {
      attributes.uv.reserve(soup_.indices.size());
      for (const std::uint32_t index : soup_.indices) attributes.uv.push_back(vertex_uv_[index]);
    }
    if (!attributes.face_colours.empty()) attributes.face_colours.resize(soup_.polygon_count());
    if (attributes.uv.empty() || header_.textures.empty()) return;
    for (const PlyTexture& texture : header_.textures) {
      attributes.materials.push_back({.name = display_name(texture.name),
                                      .colour = {},
                                      .texture = textures.load(texture.name, "", absl::StrFormat("line %d", texture.line))});
    }
    const auto count = static_cast<float>(attributes.materials.size());
    attributes.material_of_face.assign(soup_.polygon_count(), 0);
    for (std::size_t p = 0; p < std::min(texture_numbers_.size(), soup_.polygon_count()); ++p) {
      const float number = texture_numbers_[p];
      attributes.material_of_face[p] =
          number >= 0 && number < count ? static_cast<std::uint32_t>(number) : MeshAttributes::kNoMaterial;
    }
  }

  const PlyHeader& header_;
  Source source_;
  ReadMonitor monitor_;
  PolygonSoup soup_;
  std::optional<std::uint64_t> vertex_count_;
  std::vector<Vec2f> vertex_uv_;
  std::vector<float> texture_numbers_;  // of the polygons so far
  std::vector<Vec2f> face_uv_;          // of the face at hand
};

template <class Source>
absl::StatusOr<PolygonSoup> read_body(const MeshFile& file, const PlyHeader& header, const ExecutionContext& context) {
  return PlyBodyReader<Source>(file.text(), header, context).read(file);
}

}  // namespace

absl::StatusOr<PolygonSoup> read_ply(const MeshFile& file, const ExecutionContext& context) {
  const absl::StatusOr<PlyHeader> header = parse_ply_header(file.text());
  if (!header.ok()) return header.status();
  switch (header->format) {
    case PlyFormat::kAscii:
      return read_body<PlyTextSource>(file, *header, context);
    case PlyFormat::kBinaryLittleEndian:
      return read_body<PlyBinarySource<false>>(file, *header, context);
    case PlyFormat::kBinaryBigEndian:
      return read_body<PlyBinarySource<true>>(file, *header, context);
  }
  return absl::InternalError("unknown PLY format");
}

}  // namespace curvecast
