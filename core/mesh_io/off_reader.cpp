#include "core/mesh_io/off_reader.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/base/text_scanner.h"
#include "core/mesh_io/reading/mesh_reading.h"
#include "core/mesh_io/reading/texture_loader.h"
#include "core/mesh_io/text_colours.h"

namespace curvecast {
namespace {

struct OffKeyword {
  bool valid = false;
  bool places = false;         // "ST": texture coordinates
  bool colours = false;        // "C"
  bool normals = false;        // "N"
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
  keyword.places = take("ST");
  keyword.colours = take("C");
  keyword.normals = take("N");
  if (!keyword.colours) keyword.colours = take("C");  // some write NCOFF
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
    finish_attributes();
    return std::move(soup_);
  }

 private:
  absl::Status read_header() {
    scanner_.skip_space_and_comments('#');
    if (const OffKeyword keyword = parse_keyword(scanner_.peek_word());
        keyword.valid) {  // else the counts come first: the keyword may be left out
      scanner_.skip_word();
      scanner_.skip_blanks();
      if (scanner_.peek_word() == "BINARY") return scanner_.error("binary OFF is not supported; save it as text or as PLY");
      keyword_ = keyword;
      if (keyword.n_dimensional) return scanner_.error("OFF in n dimensions is not supported; save it with x y z only");
    }
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
    const bool has_attributes = keyword_.normals || keyword_.colours || keyword_.places;
    if (keyword_.normals) soup_.attributes.normals.resize(vertex_count_, Vec3f::Zero());
    if (keyword_.places) places_.resize(vertex_count_, Vec2f::Zero());
    for (std::uint64_t i = 0; i < vertex_count_; ++i) {
      if (!monitor_.tick(scanner_.offset())) return monitor_.status();
      scanner_.skip_space_and_comments('#');
      Vec3d p;
      for (int axis = 0; axis < 3; ++axis) {
        scanner_.skip_blanks();
        if (!scanner_.number(p[axis])) return expected_in("a coordinate of vertex ", i, vertex_count_);
      }
      if (keyword_.homogeneous) {
        double w = 1;
        scanner_.skip_blanks();
        if (!scanner_.number(w)) return expected_in("the fourth coordinate of vertex ", i, vertex_count_);
        p /= w;
      }
      if (!is_finite(p)) return scanner_.error(kNotFinite);
      if (has_attributes) read_attributes(i);
      soup_.positions.push_back(p);
      scanner_.next_line();
    }
    return absl::OkStatus();
  }

  // Numbers up to the end of the line; how many there are, at most `most`.
  template <std::size_t kMost>
  std::size_t read_numbers(std::array<float, kMost>& numbers) {
    std::size_t count = 0;
    double value = 0;
    for (scanner_.skip_blanks(); count < kMost && scanner_.number(value); scanner_.skip_blanks()) {
      numbers[count++] = static_cast<float>(value);
    }
    return count;
  }

  // Behind the coordinates, in this order: normal, colour (three or four numbers), texture coordinates.
  void read_attributes(std::size_t vertex) {
    std::array<float, 9> numbers{};
    const std::size_t count = read_numbers(numbers);
    const std::size_t before = keyword_.normals ? 3 : 0;
    const std::size_t behind = keyword_.places ? 2 : 0;
    const std::size_t channels = std::min<std::size_t>(count - std::min(count, before + behind), 4);
    if (count < before + behind || (keyword_.colours && channels < 3)) {
      if (incomplete_++ == 0) incomplete_line_ = scanner_.line();
      return;
    }
    if (keyword_.normals) soup_.attributes.normals[vertex] = Vec3f(numbers[0], numbers[1], numbers[2]);
    const float* next = numbers.data() + before;
    if (keyword_.colours) {
      colours_.put(vertex, {next[0], next[1], next[2], channels == 4 ? next[3] : -1.0F});
      next += channels;
    }
    if (keyword_.places) places_[vertex] = Vec2f(next[0], next[1]);
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
      const std::size_t polygon = soup_.polygon_count();
      if (!close_polygon(soup_)) return scanner_.error(kTooManyCorners);
      // A single number is an index into a table of Geomview's own.
      std::array<float, 4> rgba{};
      const std::size_t channels = read_numbers(rgba);
      if (channels == 3) rgba[3] = -1;
      if (channels >= 3 && soup_.polygon_count() > polygon) face_colours_.put(polygon, rgba);
      scanner_.next_line();
    }
    return absl::OkStatus();
  }

  void finish_attributes() {
    MeshAttributes& attributes = soup_.attributes;
    attributes.colours = colours_.take(soup_.positions.size());
    attributes.face_colours = face_colours_.take(soup_.polygon_count());
    if (incomplete_ > 0) {
      add_warning(
          soup_.warnings, incomplete_line_,
          absl::StrFormat("this vertex lacks some of the normal, colour and texture coordinates that the file's first word "
                          "promises, and so do %d more; they are left out.",
                          incomplete_ - 1));
    }
    if (incomplete_ == vertex_count_) {
      attributes.normals.clear();
    } else if (keyword_.places) {
      attributes.uv.reserve(soup_.indices.size());
      for (const std::uint32_t index : soup_.indices) attributes.uv.push_back(places_[index]);
    }
  }

  absl::Status expected_in(std::string_view what, std::uint64_t number, std::uint64_t count) const {
    return scanner_.expected(absl::StrFormat("%s%d of %d", what, number, count));
  }

  TextScanner scanner_;
  ReadMonitor monitor_;
  PolygonSoup soup_;
  std::uint64_t vertex_count_ = 0;
  std::uint64_t face_count_ = 0;
  OffKeyword keyword_;
  TextColours colours_;
  TextColours face_colours_;
  std::vector<Vec2f> places_;     // of the vertices
  std::uint64_t incomplete_ = 0;  // vertices without the attributes that the keyword promises
  std::size_t incomplete_line_ = 0;
};

}  // namespace

bool is_off_keyword(std::string_view word) { return parse_keyword(word).valid; }

absl::StatusOr<PolygonSoup> read_off(std::string_view text, const ExecutionContext& context) {
  return OffReader(text, context).read();
}

}  // namespace curvecast
