#include "core/mesh/off_reader.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <utility>

#include "core/mesh/mesh_reading.h"
#include "core/mesh/text_scanner.h"

namespace curvecast {
namespace {

struct OffKeyword {
  bool valid = false;
  bool homogeneous = false;    // "4": x y z w
  bool n_dimensional = false;  // "n": a dimension stands before the counts
};

OffKeyword parse_keyword(std::string_view word) {
  OffKeyword keyword;
  const auto take = [&word](std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  take("ST");
  take("C");
  take("N");
  keyword.homogeneous = take("4");
  keyword.n_dimensional = take("n");
  keyword.valid = word == "OFF";
  return keyword;
}

class OffReader {
 public:
  OffReader(std::string_view text, const ExecutionContext& context) : scanner_(text), monitor_(context, text.size()) {}

  absl::StatusOr<PolygonSoup> read() {
    soup_.polygon_begin.push_back(0);
    if (absl::Status status = read_header(); !status.ok()) return status;
    if (absl::Status status = read_vertices(); !status.ok()) return status;
    if (absl::Status status = read_faces(); !status.ok()) return status;
    return std::move(soup_);
  }

 private:
  absl::Status read_header() {
    scanner_.skip_space_and_comments('#');
    const OffKeyword keyword = parse_keyword(scanner_.peek_word());
    if (keyword.valid) {  // else the counts come first: the keyword may be left out
      scanner_.skip_word();
      scanner_.skip_blanks();
      if (scanner_.peek_word() == "BINARY") return scanner_.error("binary OFF is not supported; save it as text or as PLY");
      if (keyword.n_dimensional) return scanner_.error("OFF in n dimensions is not supported; save it with x y z only");
    }
    homogeneous_ = keyword.homogeneous;
    // No vertex takes less than "0 0 0\n", no face less than "0\n"; the last line end may be missing.
    if (absl::Status status = read_count("the number of vertices", 6, vertex_count_); !status.ok()) return status;
    if (absl::Status status = read_count("the number of faces", 2, face_count_); !status.ok()) return status;
    if (vertex_count_ > kMaxVertices) return scanner_.error(kTooManyVertices);
    scanner_.next_line();  // and with it the number of edges, which many writers leave at 0
    return absl::OkStatus();
  }

  absl::Status read_count(std::string_view what, std::size_t smallest, std::uint64_t& count) {
    scanner_.skip_space_and_comments('#');
    std::int64_t value = 0;
    if (!scanner_.integer(value)) return scanner_.expected(what);
    if (value < 0) return scanner_.error(absl::StrFormat("%s is negative", what));
    count = static_cast<std::uint64_t>(value);
    const std::size_t fit = (scanner_.remaining() + 1) / smallest;
    if (count <= fit) return absl::OkStatus();
    return scanner_.error(absl::StrFormat("%s is %d, but the file is too short for more than %d", what, count, fit));
  }

  absl::Status read_vertices() {
    soup_.positions.reserve(vertex_count_);
    for (std::uint64_t i = 0; i < vertex_count_; ++i) {
      if (!monitor_.tick(scanner_.offset())) return monitor_.status();
      scanner_.skip_space_and_comments('#');
      Vec3d p;
      for (int axis = 0; axis < 3; ++axis) {
        scanner_.skip_blanks();
        if (!scanner_.number(p[axis])) return expected_in("a coordinate of vertex ", i, vertex_count_);
      }
      if (homogeneous_) {
        double w = 1;
        scanner_.skip_blanks();
        if (!scanner_.number(w)) return expected_in("the fourth coordinate of vertex ", i, vertex_count_);
        p /= w;
      }
      if (!is_finite(p)) return scanner_.error(kNotFinite);
      soup_.positions.push_back(p);
      scanner_.next_line();
    }
    return absl::OkStatus();
  }

  absl::Status read_faces() {
    soup_.polygon_begin.reserve(face_count_ + 1);
    soup_.indices.reserve(std::min<std::size_t>(3 * face_count_, scanner_.remaining() / 2));
    for (std::uint64_t i = 0; i < face_count_; ++i) {
      if (!monitor_.tick(scanner_.offset())) return monitor_.status();
      scanner_.skip_space_and_comments('#');
      std::int64_t corners = 0;
      if (!scanner_.integer(corners)) return expected_in("the number of corners of face ", i, face_count_);
      if (corners < 0) return scanner_.error(absl::StrFormat("face %d has a negative number of corners", i));
      for (std::int64_t corner = 0; corner < corners; ++corner) {
        if (!monitor_.tick(scanner_.offset())) return monitor_.status();
        scanner_.skip_space_and_comments('#');
        std::int64_t index = 0;
        if (!scanner_.integer(index)) return expected_in("a vertex index of face ", i, face_count_);
        if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count_) {
          return scanner_.error(index_out_of_range(index, vertex_count_));
        }
        soup_.indices.push_back(static_cast<std::uint32_t>(index));
      }
      if (!close_polygon(soup_)) return scanner_.error(kTooManyCorners);
      scanner_.next_line();  // and with it the face's colour
    }
    return absl::OkStatus();
  }

  absl::Status expected_in(std::string_view what, std::uint64_t number, std::uint64_t count) const {
    return scanner_.expected(absl::StrFormat("%s%d of %d", what, number, count));
  }

  TextScanner scanner_;
  ReadMonitor monitor_;
  PolygonSoup soup_;
  std::uint64_t vertex_count_ = 0;
  std::uint64_t face_count_ = 0;
  bool homogeneous_ = false;
};

}  // namespace

bool is_off_keyword(std::string_view word) { return parse_keyword(word).valid; }

absl::StatusOr<PolygonSoup> read_off(std::string_view text, const ExecutionContext& context) {
  return OffReader(text, context).read();
}

}  // namespace curvecast
