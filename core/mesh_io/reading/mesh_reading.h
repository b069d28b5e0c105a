// What the readers of all mesh formats share: growing a soup, watching for cancellation, wording errors.
#pragma once

#include <absl/status/status.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// Elements between two looks at the context.
inline constexpr std::size_t kReadBlock = 65'536;

/// Looks at the context once per kReadBlock elements.
class ReadMonitor {
 public:
  /// `bytes` is the size of the whole file. Keeps a reference to `context`.
  ReadMonitor(const ExecutionContext& context, std::size_t bytes) : context_(context), bytes_(bytes) {}

  /// To be called as elements are read, with the bytes read so far. False once cancelled.
  bool tick(std::size_t offset, std::size_t elements = 1) {
    if (elements >= left_) return look(offset);
    left_ -= elements;
    return true;
  }
  /// Reports progress at once. False once cancelled.
  bool look(std::size_t offset) {
    left_ = kReadBlock;
    if (bytes_ > 0) context_.progress("read", static_cast<double>(offset) / static_cast<double>(bytes_));
    return !context_.cancelled();
  }
  absl::Status status() const { return context_.check(); }

 private:
  const ExecutionContext& context_;
  std::size_t bytes_;
  std::size_t left_ = kReadBlock;
};

inline bool is_finite(const Vec3d& p) { return std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z()); }

/// Makes room for `size` elements, of which more may come: many small steps take linear time, one large step no more than it
/// needs.
template <class T>
void grow(std::vector<T>& items, std::size_t size) {
  if (size > items.capacity()) items.reserve(std::max(size, 2 * items.capacity()));
}

/// Makes a polygon of the indices appended since the last one; drops them when they are fewer than three. False when
/// the soup is full (2^32 corners).
inline bool close_polygon(PolygonSoup& soup) {
  const std::uint32_t first = soup.polygon_begin.back();
  if (soup.indices.size() > UINT32_MAX) return false;
  if (soup.indices.size() - first < 3) {
    soup.indices.resize(first);
  } else {
    soup.polygon_begin.push_back(static_cast<std::uint32_t>(soup.indices.size()));
  }
  return true;
}

/// Largest number of vertices that 32-bit indices can tell apart, one value kept as a mark.
inline constexpr std::uint64_t kMaxVertices = UINT32_MAX;

inline constexpr char kTooManyCorners[] = "the polygons have more than 4294967295 corners in all; split the mesh";
inline constexpr char kTooManyVertices[] = "the file has more than 4294967295 vertices; split the mesh";
inline constexpr char kNotFinite[] = "a coordinate is not a finite number";

/// "vertex index 99999 is out of range (the file has 500 vertices)"
std::string index_out_of_range(std::int64_t index, std::uint64_t vertices);

}  // namespace curvecast
