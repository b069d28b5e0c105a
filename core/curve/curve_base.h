// Holds what a curve lies on, in the form in which its refinement and places within its leaves want it: in memory or in a mapped
// file, of which only those charts are read that are asked for.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/base/column.h"
#include "core/base/execution_context.h"
#include "core/base/mutex.h"
#include "core/curve/locate_triangle.h"
#include "core/curve/parameter_triangle.h"
#include "core/curve/surface_map.h"
#include "core/flatten/chart_view.h"

namespace curvecast {

/// A chart, and what is known of it besides.
struct BaseChart : ChartView {
  Column<std::uint8_t> kinds;  // of each triangle: see triangle_kinds()
  bool fills_square = false;   // see fill_square()
};

/// `data` and `charts` are those that the curve was made with; what they look at outlives it. Before a disc's chart is used, or
/// what the mesh has for its faces, is_sound() is asked: any number of threads may.
class CurveBase {
 public:
  /// Says what is wrong with a disc's chart or its faces, which have not been looked at so far.
  using Check = std::function<absl::Status(std::size_t disc)>;

  /// Says whether what the arrays look at is still there.
  using IsThere = std::function<absl::Status()>;

  /// Everything is at hand and known to be sound. To be dropped once the context is cancelled.
  CurveBase(SurfaceData surface, std::span<const Chart> all_charts, const ExecutionContext& context = {});
  /// `face_triangles`: see triangle_of. `check` is called once at most for each disc, and `is_there` at any time, by any thread.
  /// `in_file`: where the arrays take no memory that the system could not have back.
  CurveBase(SurfaceData surface, std::vector<BaseChart> all_charts, Column<std::uint32_t> face_triangles, Check check,
            IsThere is_there = {}, bool in_file = true);
  CurveBase(const CurveBase&) = delete;
  CurveBase& operator=(const CurveBase&) = delete;

  ParameterMesh mesh_of(std::size_t disc) const { return ParameterMesh(charts[disc]); }
  /// A triangle of a disc, to begin a search with: if the face lies in the disc, the first that is a part of it. Precondition:
  /// the disc is sound.
  std::uint32_t triangle_in(std::size_t disc, std::uint32_t face) const {
    const std::uint32_t t = triangle_of[face];
    return t < charts[disc].triangles.size() ? t : 0;
  }
  /// Says whether a face lies in a disc. Precondition: the disc is sound.
  bool has_face(std::size_t disc, std::uint32_t face) const {
    return face < triangle_of.size() && charts[disc].face_of[triangle_in(disc, face)] == face;
  }

  /// Says whether a disc can be used. If not, its file is damaged, and status() says how.
  bool is_sound(std::size_t disc) const {
    const State state = states_ == nullptr ? State::kSound : states_[disc].load(std::memory_order_acquire);
    return state == State::kUnknown ? check_disc(disc) : state == State::kSound;
  }
  /// Says whether all discs can be used; looks at those that nobody has looked at.
  bool is_all_sound() const;
  /// OK, or the first error that is_sound() found, or that some of the file is gone. Takes microseconds.
  absl::Status status() const;

  /// Says whether all of it is in memory, and nothing in a file.
  bool is_in_memory() const { return !in_file_; }
  /// Returns the bytes of all that it looks at but for textures.
  std::uint64_t byte_size() const;

  const SurfaceData data;
  const std::vector<BaseChart> charts;
  const Column<std::uint32_t> triangle_of;  // of each face: the first triangle, of its disc, that is a part of it
  std::vector<SurfaceMapper> mappers;       // of each chart

 private:
  enum class State : std::uint8_t { kUnknown, kSound, kDamaged };

  bool check_disc(std::size_t disc) const;

  const Check check_;
  const IsThere is_there_;
  const bool in_file_ = false;
  std::unique_ptr<std::atomic<State>[]> states_;  // null: all are sound
  const std::unique_ptr<std::once_flag[]> once_;
  mutable Mutex mutex_;
  mutable absl::Status status_ ABSL_GUARDED_BY(mutex_);
};

/// Starts the curve that follows `curve` on the same surface: sets everything but its vertices.
SurfaceCurve next_revision(const SurfaceCurve& curve);

}  // namespace curvecast
