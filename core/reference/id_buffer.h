// Finds the triangle under each leaf's centre as the paper does (section 3.3): draws the parameter mesh with a number for each
// triangle, in sections of the square, with OSMesa; and checks what it reads.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <span>

#include "core/base/execution_context.h"
#include "core/curve/adaptive_quadtree.h"
#include "core/curve/parameter_triangle.h"
#include "core/flatten/flatten.h"

namespace curvecast {

/// How much of the work the pictures did.
struct IdBufferCounts {
  std::uint64_t sections = 0;  // drawn
  std::uint64_t texels = 0;    // in them
  std::uint64_t walked = 0;    // centres for which the texel's triangle was not yet the right one
  std::uint64_t searched = 0;  // of those, the ones to which no walk led
};

/// Keeps its GL context and its textures for the next disc. One thread at a time.
class IdBuffer {
 public:
  /// Unimplemented where OSMesa is not installed.
  static absl::Status check();
  /// As check(); Unavailable when OSMesa gives no context.
  static absl::StatusOr<std::unique_ptr<IdBuffer>> create();
  IdBuffer(const IdBuffer&) = delete;
  ~IdBuffer();

  /// Writes to `under` (L entries) the triangle of the disc that holds each leaf's centre, within rounding, as locate_centres()
  /// does: a texel near an edge may show the wrong triangle, so each is checked in double precision, and where it fails a walk
  /// across the disc's edges finds the right one. Leaves the thread without a GL context. `triangles`: of the chart; the leaves'
  /// own lists are not used. The same for any number of threads. `counts`, where not null, is added to. Cancelled;
  /// ResourceExhausted or Internal when OSMesa fails.
  absl::Status locate(const Chart& chart, std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves,
                      std::span<std::uint32_t> under, const ExecutionContext& context = {}, IdBufferCounts* counts = nullptr);

 private:
  class Canvas;

  explicit IdBuffer(std::unique_ptr<Canvas> canvas);

  std::unique_ptr<Canvas> canvas_;
};

}  // namespace curvecast
