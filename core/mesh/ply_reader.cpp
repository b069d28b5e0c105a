#include "core/mesh/ply_reader.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/mesh/mesh_reading.h"
#include "core/mesh/ply_header.h"
#include "core/mesh/ply_source.h"
#include "core/mesh/text_scanner.h"

namespace curvecast {
namespace {

constexpr std::size_t kNotThere = SIZE_MAX;

enum class Role { kVertices, kPolygons, kStrips, kOther };

Role role_of(const PlyElement& element) {
  if (element.name == "vertex") return Role::kVertices;
  if (element.name == "face") return Role::kPolygons;
  if (element.name == "tristrips") return Role::kStrips;
  return Role::kOther;
}

// The list of vertex indices among the properties; kNotThere without one.
std::size_t find_index_list(const PlyElement& element) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    const bool name_fits = property.name == "vertex_indices" || property.name == "vertex_index";
    if (name_fits && property.is_list && is_integer(property.type)) return i;
  }
  return kNotThere;
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

  absl::StatusOr<PolygonSoup> read() {
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
    std::size_t place[3];
    for (int axis = 0; axis < 3; ++axis) {
      constexpr std::string_view kNames[] = {"x", "y", "z"};
      const auto found = std::find_if(element.properties.begin(), element.properties.end(), [&](const PlyProperty& property) {
        return property.name == kNames[axis] && !property.is_list;
      });
      if (found == element.properties.end()) {
        return absl::InvalidArgumentError(absl::StrFormat("the element 'vertex' has no property '%s'", kNames[axis]));
      }
      place[axis] = static_cast<std::size_t>(found - element.properties.begin());
    }
    if constexpr (kBinary) {
      const PlyType type = element.properties[place[0]].type;
      const bool same = type == element.properties[place[1]].type && type == element.properties[place[2]].type;
      if (same && fixed_size(element) && type == PlyType::kFloat32) return read_fixed_vertices<float>(element, place);
      if (same && fixed_size(element) && type == PlyType::kFloat64) return read_fixed_vertices<double>(element, place);
    }
    std::vector<int> axis_of(element.properties.size(), -1);
    for (int axis = 0; axis < 3; ++axis) axis_of[place[axis]] = axis;
    soup_.positions.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!monitor_.tick(source_.offset())) return monitor_.status();
      Vec3d p;
      for (std::size_t j = 0; j < axis_of.size(); ++j) {
        const PlyProperty& property = element.properties[j];
        if (axis_of[j] < 0) {
          if (absl::Status status = skip_property(element, property, i); !status.ok()) return status;
        } else if (!source_.real(property.type, p[axis_of[j]])) {
          return source_.missing(element, i);
        }
      }
      if (!is_finite(p)) return source_.error(element.name, i, kNotFinite);
      soup_.positions.push_back(p);
    }
    return absl::OkStatus();
  }

  // All vertices of one size, their coordinates of one type.
  template <class T>
  absl::Status read_fixed_vertices(const PlyElement& element, const std::size_t (&place)[3]) {
    std::size_t offsets[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t j = 0; j < place[axis]; ++j) offsets[axis] += ply_type_bytes(element.properties[j].type);
    }
    const std::size_t stride = *fixed_size(element);
    soup_.positions.resize(element.count);
    for (std::size_t first = 0; first < element.count; first += kReadBlock) {
      if (!monitor_.look(source_.offset())) return monitor_.status();
      const std::size_t count = std::min<std::size_t>(kReadBlock, element.count - first);
      const char* const block = source_.data();
      Vec3d* const out = soup_.positions.data() + first;
      bool finite = true;
      for (std::size_t i = 0; i < count; ++i) {
        const char* const p = block + i * stride;
        out[i] = Vec3d(Source::template at<T>(p + offsets[0]), Source::template at<T>(p + offsets[1]),
                       Source::template at<T>(p + offsets[2]));
        finite &= is_finite(out[i]);
      }
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
    if (list == kNotThere) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the element '%s' has no list 'vertex_indices' (or 'vertex_index') of integers", element.name));
    }
    const bool strips = role_of(element) == Role::kStrips;
    if (!strips) {
      soup_.polygon_begin.reserve(soup_.polygon_begin.size() + element.count);
      soup_.indices.reserve(soup_.indices.size() + std::min<std::uint64_t>(3 * element.count, source_.scalars_left()));
    }
    const PlainFace plain = strips ? PlainFace{} : plain_face(element, list);
    for (std::uint64_t i = 0; i < element.count;) {
      const std::size_t triangles = plain.size > 0 ? read_plain_triangles(plain, element.count - i) : 0;
      if (!monitor_.tick(source_.offset(), triangles + 1)) return monitor_.status();
      i += triangles;
      if (triangles > 0) continue;
      for (std::size_t j = 0; j < element.properties.size(); ++j) {
        const PlyProperty& property = element.properties[j];
        absl::Status status;
        if (j != list) {
          status = skip_property(element, property, i);
        } else {
          status = strips ? read_strips(element, property, i) : read_polygon(element, property, i);
        }
        if (!status.ok()) return status;
      }
      ++i;
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

  // A face of one list (1-byte length, 4-byte indices) and nothing else of varying size: most files. `size` is 0 for other faces.
  struct PlainFace {
    std::size_t size = 0;  // of a triangle, bytes
    std::size_t list = 0;  // offset of the list
    std::uint64_t largest_index = 0;
  };

  PlainFace plain_face(const PlyElement& element, std::size_t list) const {
    if constexpr (!kBinary) return {};
    PlainFace face;
    for (std::size_t j = 0; j < element.properties.size(); ++j) {
      const PlyProperty& property = element.properties[j];
      if (property.is_list != (j == list)) return {};
      if (j == list) face.list = face.size;
      face.size += j == list ? 13 : ply_type_bytes(property.type);
    }
    const PlyProperty& indices = element.properties[list];
    if (ply_type_bytes(indices.count_type) != 1 || ply_type_bytes(indices.type) != 4 || *vertex_count_ == 0) return {};
    face.largest_index = std::min<std::uint64_t>(*vertex_count_ - 1, indices.type == PlyType::kInt32 ? INT32_MAX : UINT32_MAX);
    return face;
  }

  // The run of triangles that comes next, at most `most`; returns how many. 0 when a polygon, a fault or the end comes next,
  // to be looked at one by one.
  std::size_t read_plain_triangles(const PlainFace& face, std::uint64_t most) {
    if constexpr (kBinary) {
      constexpr std::uint64_t kLongestRun = 4096;  // small enough to be still in the cache the second time
      const std::size_t room =
          std::min({most, kLongestRun, source_.remaining() / face.size, (UINT32_MAX - soup_.indices.size()) / 3});
      const char* const p = source_.data() + face.list;
      std::size_t run = 0;
      while (run < room && p[run * face.size] == 3) ++run;
      const std::size_t old_size = soup_.indices.size();
      soup_.indices.resize(old_size + 3 * run);
      std::uint32_t largest = 0;
      for (std::size_t i = 0; i < run; ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const std::uint32_t index = Source::template at<std::uint32_t>(p + i * face.size + 1 + 4 * corner);
          largest = std::max(largest, index);
          soup_.indices[old_size + 3 * i + corner] = index;
        }
      }
      if (largest > face.largest_index) {
        soup_.indices.resize(old_size);
        return 0;
      }
      for (std::size_t i = 1; i <= run; ++i) soup_.polygon_begin.push_back(static_cast<std::uint32_t>(old_size + 3 * i));
      source_.advance(run * face.size);
      return run;
    } else {
      return 0;
    }
  }

  const PlyHeader& header_;
  Source source_;
  ReadMonitor monitor_;
  PolygonSoup soup_;
  std::optional<std::uint64_t> vertex_count_;
};

}  // namespace

absl::StatusOr<PolygonSoup> read_ply(std::string_view bytes, const ExecutionContext& context) {
  const absl::StatusOr<PlyHeader> header = parse_ply_header(bytes);
  if (!header.ok()) return header.status();
  switch (header->format) {
    case PlyFormat::kAscii:
      return PlyBodyReader<PlyTextSource>(bytes, *header, context).read();
    case PlyFormat::kBinaryLittleEndian:
      return PlyBodyReader<PlyBinarySource<false>>(bytes, *header, context).read();
    case PlyFormat::kBinaryBigEndian:
      return PlyBodyReader<PlyBinarySource<true>>(bytes, *header, context).read();
  }
  return absl::InternalError("unknown PLY format");
}

}  // namespace curvecast
