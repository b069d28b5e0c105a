// Points on their way to a client.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <optional>

#include "core/codec/draco_codec.h"
#include "core/curve/surface_curve.h"
#include "core/progressive/rank_delta.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/sample.h"

namespace curvecast::server {

/// Points [begin, begin + count) as one block; `curve` is the one that they were sampled from. The attributes are left to the
/// other function.
absl::StatusOr<v1::PointBlock> to_proto(const PointSet& points, std::size_t begin, std::size_t count, const SurfaceCurve& curve,
                                        const std::optional<DracoOptions>& draco);

/// The attributes asked for, of the same points.
v1::PointAttributes to_proto(const PointSet& points, std::size_t begin, std::size_t count, const SurfaceCurve& curve,
                             const PointAttributes& wanted);

/// Changes of a list, as the API writes them; `curve` is the one that has the ranks.
v1::PointEdits to_proto(const RankDelta& delta, const ListDelta& places, const SurfaceCurve& curve);

}  // namespace curvecast::server
