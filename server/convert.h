// The only code between core and proto: checks every field that a client sent, and converts both ways.
#pragma once

#include <absl/status/statusor.h>

#include <optional>

#include "core/codec/draco_codec.h"
#include "core/pipeline.h"
#include "core/sample/rank_delta.h"
#include "core/sample/resample.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/session.h"

namespace curvecast::server {

/// Which sampler places the points: see resample() and sample_ranked().
enum class Sampler { kEqualised, kProgressive };

/// More of each point.
struct PointAttributes {
  bool curvatures = false;
  bool rank = false;
  bool surface = false;

  bool operator==(const PointAttributes&) const = default;
};

/// What a client asked for in a SampleRequest, checked as far as that goes without the session.
struct Sample {
  Sampler sampler = Sampler::kEqualised;
  PointAttributes attributes;
  ResampleOptions options;            // `points` as asked for; not used with one of the other budgets
  double pixel_error = 0;             // above 0: instead of a number of points
  std::uint64_t max_bytes = 0;        // above 0: instead of a number of points
  std::optional<DracoOptions> draco;  // bits only; the lattice is the session's. Not set: raw floats
};

// Defaults are filled in. InvalidArgument names the field at fault and its value.
absl::StatusOr<Sample> to_sample(const v1::SampleRequest& request);
absl::StatusOr<PreprocessOptions> to_preprocess_options(const v1::SessionOptions& options);
absl::StatusOr<Parameteriser> to_parameteriser(const std::string& field, v1::Parameteriser parameteriser);

v1::Vec3 to_proto(const Vec3d& v);
v1::MeshInfo to_proto(const MeshInfo& info, const std::string& name);
v1::Distortion to_proto(const Distortion& distortion);
v1::Session to_proto(const SessionInfo& info);
v1::Session to_proto(const Session& session);

/// Points [begin, begin + count) as one block; `curve` is the one that they were sampled from. The attributes are left to the
/// other function.
absl::StatusOr<v1::PointBlock> to_proto(const PointSet& points, std::size_t begin, std::size_t count, const SurfaceCurve& curve,
                                        const std::optional<DracoOptions>& draco);

/// The attributes asked for, of the same points.
v1::PointAttributes to_proto(const PointSet& points, std::size_t begin, std::size_t count, const SurfaceCurve& curve,
                             const PointAttributes& wanted);

/// Changes of a list, as the API writes them; `curve` is the one that has the ranks.
v1::PointEdits to_proto(const RankDelta& delta, const ListDelta& places, const SurfaceCurve& curve);

v1::FrameError to_proto(const absl::Status& status);

}  // namespace curvecast::server
