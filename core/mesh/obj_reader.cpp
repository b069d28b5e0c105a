#include "core/mesh/obj_reader.h"

#include <absl/strings/str_format.h>

#include <utility>
#include <vector>

#include "core/mesh/mesh_reading.h"
#include "core/mesh/text_scanner.h"

namespace curvecast {
namespace {

class ObjReader {
 public:
  ObjReader(std::string_view text, const ExecutionContext& context) : scanner_(text), monitor_(context, text.size()) {}

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
      }
      if (!status.ok()) return status;
      comment ? scanner_.next_line() : skip_statement();
    }
    return check_forward_references();
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
    soup_.positions.push_back(p);
    return absl::OkStatus();
  }

  absl::Status read_face() {
    for (skip_blanks(); !scanner_.at_line_end() && scanner_.peek() != '#'; skip_blanks()) {
      std::int64_t number = 0;
      if (!scanner_.integer(number)) return scanner_.expected("a vertex index");
      if (!skip_texture_and_normal()) return scanner_.expected("a vertex index such as 7, 7/8, 7//9 or 7/8/9");
      if (number == 0) return scanner_.error("vertex index 0 is out of range (OBJ counts from 1, or from -1 backwards)");
      const auto vertices = static_cast<std::int64_t>(soup_.positions.size());
      const std::int64_t index = number > 0 ? number - 1 : vertices + number;
      if (index < 0 || index >= static_cast<std::int64_t>(kMaxVertices)) {
        return scanner_.error(index_out_of_range(number, soup_.positions.size()));
      }
      if (index >= vertices && (forward_.empty() || index > forward_.back().index)) {
        forward_.push_back({static_cast<std::uint32_t>(index), scanner_.line()});
      }
      soup_.indices.push_back(static_cast<std::uint32_t>(index));
      if (!monitor_.tick(scanner_.offset())) return monitor_.status();
    }
    return close_polygon(soup_) ? absl::OkStatus() : scanner_.error(kTooManyCorners);
  }

  // Behind a vertex index: nothing, /8, //9 or /8/9. The numbers themselves may be missing: exporters write "7//" as well.
  bool skip_texture_and_normal() {
    for (int part = 0; part < 2 && scanner_.peek() == '/'; ++part) {
      scanner_.skip_char();
      if (scanner_.peek() == '-') scanner_.skip_char();
      while (scanner_.peek() >= '0' && scanner_.peek() <= '9') scanner_.skip_char();
    }
    const char c = scanner_.peek();
    return scanner_.at_line_end() || c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\\';
  }

  absl::StatusOr<PolygonSoup> check_forward_references() {
    for (const ForwardReference& reference : forward_) {
      if (reference.index < soup_.positions.size()) continue;
      const std::string what = index_out_of_range(std::int64_t{reference.index} + 1, soup_.positions.size());
      return absl::InvalidArgumentError(absl::StrFormat("line %d: %s", reference.line, what));
    }
    return std::move(soup_);
  }

  TextScanner scanner_;
  ReadMonitor monitor_;
  PolygonSoup soup_;
  std::vector<ForwardReference> forward_;
};

}  // namespace

absl::StatusOr<PolygonSoup> read_obj(std::string_view text, const ExecutionContext& context) {
  return ObjReader(text, context).read();
}

}  // namespace curvecast
