#include "server/point_blocks.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/curve/shortfall.h"
#include "core/stopwatch.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kRawPointBytes = 2 * sizeof(Vec3f) + sizeof(float);
constexpr std::size_t kRawColourBytes = 3;

struct Sampled {
  std::shared_ptr<const SurfaceCurve> curve;  // one revision for all of an answer
  Workspaces::Lease workspace;                // holds the points
  v1::FrameStatistics statistics;
};

absl::StatusOr<Sampled> sample_curve(const Session& session, const Sample& sample, ViewCache& cache, const OnShort& on_short) {
  Sampled out{session.curve(), cache.workspaces.take(), {}};
  Stopwatch watch;
  const auto fixed = cache.fixed_densities.get(out.curve, sample.options.density);
  if (!fixed.ok()) return fixed.status();
  const double fixed_seconds = watch.lap();
  ResampleReport report;
  if (absl::Status status = resample(*out.curve, fixed->get(), sample.options, *out.workspace, &report); !status.ok())
    return status;
  out.statistics.set_density_seconds(fixed_seconds + report.density_seconds);
  out.statistics.set_equalise_seconds(report.equalise_seconds);
  out.statistics.set_curve_vertices(out.curve->size());
  const bool is_short = session.options.omega * report.most_on_vertex > kShortLoad;
  out.statistics.set_refining(is_short && on_short && on_short(*out.curve));
  return out;
}

// Adds the time that it takes to the statistics.
absl::StatusOr<v1::PointBlock> encode(Sampled& sampled, std::size_t begin, std::size_t count, const Sample& sample) {
  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<v1::PointBlock> block = to_proto(sampled.workspace->points, begin, count, *sampled.curve, sample.draco);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  sampled.statistics.set_encode_seconds(sampled.statistics.encode_seconds() + seconds);
  return block;
}

absl::Status too_large(std::size_t bytes) {
  return absl::ResourceExhaustedError(absl::StrCat("the frame would have ", bytes, " bytes; at most ", kMaxFrameBytes,
                                                   " are sent: ask for fewer points or fewer bits, or use Resample"));
}

}  // namespace

absl::Status make_blocks(const Session& session, const Sample& sample, ViewCache& cache, const OnShort& on_short,
                         const std::function<bool(v1::ResampleResponse)>& emit) {
  absl::StatusOr<Sampled> sampled = sample_curve(session, sample, cache, on_short);
  if (!sampled.ok()) return sampled.status();
  const std::size_t total = sampled->workspace->points.size();
  for (std::size_t begin = 0; begin < total; begin += kBlockPoints) {
    const std::size_t count = std::min(kBlockPoints, total - begin);
    absl::StatusOr<v1::PointBlock> block = encode(*sampled, begin, count, sample);
    if (!block.ok()) return block.status();
    v1::ResampleResponse response;
    *response.mutable_points() = *std::move(block);
    if (begin + count == total) *response.mutable_statistics() = sampled->statistics;
    if (!emit(std::move(response))) return absl::CancelledError("the client has gone");
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::PointFrame> make_frame(const Session& session, const Sample& sample, ViewCache& cache,
                                          const OnShort& on_short) {
  const std::size_t asked = sample.options.points;
  const std::size_t raw_bytes = kRawPointBytes + (session.curve()->colour.empty() ? 0 : kRawColourBytes);
  if (!sample.draco && asked <= kMaxPoints && asked > kMaxFrameBytes / raw_bytes) return too_large(asked * raw_bytes);
  absl::StatusOr<Sampled> sampled = sample_curve(session, sample, cache, on_short);
  if (!sampled.ok()) return sampled.status();
  absl::StatusOr<v1::PointBlock> block = encode(*sampled, 0, sampled->workspace->points.size(), sample);
  if (!block.ok()) return block.status();
  v1::PointFrame frame;
  frame.set_curve_revision(sampled->curve->revision);
  frame.set_kind(v1::FRAME_KIND_KEY);
  *frame.mutable_points() = *std::move(block);
  *frame.mutable_statistics() = std::move(sampled->statistics);
  if (frame.points().draco().data().size() > kMaxFrameBytes) return too_large(frame.points().draco().data().size());
  return frame;
}

}  // namespace curvecast::server
