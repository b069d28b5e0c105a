#include "core/mesh_io/stl_reader.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <utility>

#include "core/base/text_scanner.h"
#include "core/mesh_io/reading/endian.h"
#include "core/mesh_io/reading/mesh_reading.h"

namespace curvecast {
namespace {

constexpr std::size_t kTitleBytes = 80;
constexpr std::size_t kHeaderBytes = kTitleBytes + 4;
constexpr std::size_t kNormalBytes = 12;
constexpr std::size_t kTriangleBytes = 50;

std::uint64_t claimed_triangles(std::string_view bytes) { return load<std::uint32_t, false>(bytes.data() + kTitleBytes); }

absl::StatusOr<PolygonSoup> read_binary(std::string_view bytes, const ExecutionContext& context) {
  if (bytes.size() < kHeaderBytes) return absl::InvalidArgumentError("the file ends within the header of a binary STL");
  const std::uint64_t triangles = claimed_triangles(bytes);
  const std::uint64_t whole = (bytes.size() - kHeaderBytes) / kTriangleBytes;
  if (triangles > whole) {
    return absl::InvalidArgumentError(
        absl::StrFormat("triangle %d: the file ends here, but its header claims %d triangles", whole, triangles));
  }
  if (3 * triangles > kMaxVertices) return absl::InvalidArgumentError(kTooManyVertices);

  PolygonSoup soup;
  soup.shares_vertices = false;
  soup.positions.reserve(3 * triangles);
  ReadMonitor monitor(context, bytes.size());
  const char* p = bytes.data() + kHeaderBytes;
  for (std::uint64_t i = 0; i < triangles; ++i, p += kTriangleBytes) {
    if (!monitor.tick(static_cast<std::size_t>(p - bytes.data()))) return monitor.status();
    bool finite = true;
    for (int corner = 0; corner < 3; ++corner) {
      const char* const q = p + kNormalBytes + corner * 12;
      const Vec3d position(load<float, false>(q), load<float, false>(q + 4), load<float, false>(q + 8));
      finite = finite && is_finite(position);
      soup.positions.push_back(position);
    }
    if (!finite) return absl::InvalidArgumentError(absl::StrFormat("triangle %d: %s", i, kNotFinite));
  }
  soup.indices.resize(3 * triangles);
  for (std::size_t i = 0; i < soup.indices.size(); ++i) soup.indices[i] = static_cast<std::uint32_t>(i);
  soup.polygon_begin.resize(triangles + 1);
  for (std::size_t i = 0; i <= triangles; ++i) soup.polygon_begin[i] = static_cast<std::uint32_t>(3 * i);
  return soup;
}

class TextStlReader {
 public:
  TextStlReader(std::string_view text, const ExecutionContext& context) : scanner_(text), monitor_(context, text.size()) {
    soup_.shares_vertices = false;
    soup_.polygon_begin.push_back(0);
  }

  absl::StatusOr<PolygonSoup> read() {
    bool in_solid = false;
    for (;;) {
      scanner_.skip_space();
      if (scanner_.at_end()) break;
      if (!monitor_.tick(scanner_.offset())) return monitor_.status();
      if (absl::Status status = expect(in_solid ? "facet or endsolid" : "solid", in_solid ? "facet" : "solid"); status.ok()) {
        if (in_solid) {
          if (status = read_facet(); !status.ok()) return status;
        } else {
          scanner_.next_line();  // the solid's name
          in_solid = true;
        }
      } else if (in_solid && accept("endsolid")) {
        scanner_.next_line();
        in_solid = false;
      } else {
        return status;
      }
    }
    if (in_solid) return scanner_.expected("facet or endsolid");
    return std::move(soup_);
  }

 private:
  bool accept(std::string_view keyword) {
    scanner_.skip_space();
    if (!equals_ignoring_case(scanner_.peek_word(), keyword)) return false;
    scanner_.skip_word();
    return true;
  }
  absl::Status expect(std::string_view what, std::string_view keyword) {
    return accept(keyword) ? absl::OkStatus() : scanner_.expected(what);
  }
  absl::Status expect(std::string_view keyword) { return expect(keyword, keyword); }

  // Behind the word "facet".
  absl::Status read_facet() {
    if (accept("normal")) {
      for (int axis = 0; axis < 3; ++axis) {  // often NaN or zero, and never needed
        scanner_.skip_space();
        scanner_.skip_word();
      }
    }
    if (absl::Status status = expect("outer"); !status.ok()) return status;
    if (absl::Status status = expect("loop"); !status.ok()) return status;
    while (accept("vertex")) {
      if (!monitor_.tick(scanner_.offset())) return monitor_.status();
      if (absl::Status status = read_vertex(); !status.ok()) return status;
    }
    if (absl::Status status = expect("vertex or endloop", "endloop"); !status.ok()) return status;
    if (absl::Status status = expect("endfacet"); !status.ok()) return status;
    return close_polygon(soup_) ? absl::OkStatus() : scanner_.error(kTooManyCorners);
  }

  absl::Status read_vertex() {
    Vec3d p;
    for (int axis = 0; axis < 3; ++axis) {
      scanner_.skip_space();
      if (!scanner_.number(p[axis])) return scanner_.expected("a coordinate of a vertex");
    }
    if (!is_finite(p)) return scanner_.error(kNotFinite);
    if (soup_.positions.size() == kMaxVertices) return scanner_.error(kTooManyVertices);
    soup_.indices.push_back(static_cast<std::uint32_t>(soup_.positions.size()));
    soup_.positions.push_back(p);
    return absl::OkStatus();
  }

  TextScanner scanner_;
  ReadMonitor monitor_;
  PolygonSoup soup_;
};

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + kTriangleBytes * claimed_triangles(bytes);
}

absl::StatusOr<PolygonSoup> read_stl(std::string_view bytes, const ExecutionContext& context) {
  // A text never holds a zero byte; the header of a binary file nearly always does.
  TextScanner scanner(bytes);
  scanner.skip_space();
  const bool solid = equals_ignoring_case(scanner.peek_word(), "solid");
  const bool has_zero = bytes.substr(0, std::min(bytes.size(), kHeaderBytes)).find('\0') != std::string_view::npos;
  const bool binary = is_binary_stl(bytes) || !solid || has_zero;
  return binary ? read_binary(bytes, context) : TextStlReader(bytes, context).read();
}

}  // namespace curvecast
