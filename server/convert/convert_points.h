// Converts point sets, changes of point sets and their statistics to proto.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/codec/draco_codec.h"
#include "core/curve/leaf_surface.h"
#include "core/curve/surface_curve.h"
#include "core/pipeline/scatter_mesh.h"
#include "core/progressive/rank_delta.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/point_set_request.h"

namespace curvecast::server {

/// Why a view has fewer points than wanted.
enum class PointLimit {
  kNone,     // it has as many
  kBytes,    // its budget in bytes holds no more
  kDensity,  // its density admits no more places
  kServer,   // there are to be no more ranked candidates for it
  kComing,   // more are being made, or are another part
};

/// How long the steps from a view to its blocks took, and what became of the number of points.
struct PointSetStatistics {
  double density_seconds = 0;
  double equalise_seconds = 0;  // selecting and listing, for ranked points
  double encode_seconds = 0;
  std::uint64_t curve_vertices = 0;  // of the curve that was sampled
  std::uint64_t wanted_points = 0;   // 0: as many as a budget in bytes holds
  PointLimit limit = PointLimit::kNone;
};

/// Converts all but `refining`, which the sender of the message decides.
v1::FrameStatistics to_proto(const PointSetStatistics& statistics);

/// Encodes points [begin, begin + count) as one block, without attributes. `box` is that of the surface that they lie on. Not
/// `draco`: as raw floats. Errors as of encode_draco().
absl::StatusOr<v1::PointBlock> to_proto(const PointSet& points, std::size_t begin, std::size_t count, const Box3d& box,
                                        const std::optional<DracoOptions>& draco);

/// Encodes the attributes `wanted` of points [begin, begin + count), which have places where these are needed. `surface` is that
/// below the curve, null where it is not needed. Whoever gave it looks at its status() before the answer is used.
v1::PointAttributes to_proto(const PointSet& points, std::size_t begin, std::size_t count, const SurfaceCurve& curve,
                             const LeafSurface* surface, const PointAttributes& wanted);

/// Encodes the attributes of scattered points [begin, begin + count): what was found of them and, with `places`, where they lie.
v1::PointAttributes to_proto(const ScatteredPoints& scattered, std::size_t begin, std::size_t count, bool places);

/// Converts the changes of a list of points to differences of indices; `curve` is the one that has the ranks.
v1::PointEdits to_proto(const RankDelta& delta, const ListDelta& places, const SurfaceCurve& curve);

}  // namespace curvecast::server
