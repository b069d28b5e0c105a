// A session's surface as one file of Draco, for clients that would rather have the triangles than points of them.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <string>

#include "core/base/execution_context.h"
#include "core/base/mutex.h"
#include "core/base/vec.h"
#include "core/curve/curve_base.h"
#include "server/session/session.h"

namespace curvecast::server {

/// The most triangles of a file: more would keep a client waiting for what its own views need.
inline constexpr std::size_t kMaxSurfaceFaces = 1'000'000;
/// Of each coordinate, of the box's longest side.
inline constexpr int kLeastSurfaceBits = 8, kMostSurfaceBits = 24, kSurfaceBits = 14;

struct SurfaceFile {
  std::uint64_t vertices = 0, triangles = 0;
  Vec3d origin = Vec3d::Zero();  // its positions are relative to it
  std::string bytes;
};

/// Writes the repaired mesh: positions, and colours where vertices have some. FailedPrecondition: the colour of the surface lies
/// in textures, faces or several materials, which the file would not have. OutOfRange: more than kMaxSurfaceFaces triangles.
/// ResourceExhausted; Cancelled; DataLoss as of CurveBase::status(). Precondition: position_bits in the range above.
absl::StatusOr<SurfaceFile> make_surface_file(const CurveBase& base, const Vec3d& origin, int position_bits,
                                              const ExecutionContext& context);

/// Keeps the files that were asked for last, up to a number of bytes. Thread-safe.
class SurfaceFiles {
 public:
  using Make = std::function<absl::StatusOr<SurfaceFile>()>;

  /// Returns the file of a session with positions of so many bits, or has `make` make it. Where several threads want one that is
  /// not there, each makes it. Errors are not kept.
  absl::StatusOr<std::shared_ptr<const SurfaceFile>> get(const std::string& session_id, int position_bits, const Make& make)
      ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;

  struct Entry {
    std::string session_id;
    int position_bits;
    std::shared_ptr<const SurfaceFile> file;
  };

  Mutex mutex_;
  std::list<Entry> entries_ ABSL_GUARDED_BY(mutex_);  // those used last first
  std::size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace curvecast::server
