#include "server/frame/point_blocks.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/frame/pack_points.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kBlocksAtOnce = 16;  // encoded before the first is sent

/// Hands over the next block; the last one with the statistics.
absl::Status emit_block(v1::PointBlock block, const v1::FrameStatistics* statistics,
                        const std::function<bool(v1::ResampleResponse)>& emit) {
  v1::ResampleResponse response;
  *response.mutable_points() = std::move(block);
  if (statistics != nullptr) *response.mutable_statistics() = *statistics;
  return emit(std::move(response)) ? absl::OkStatus() : absl::CancelledError("the client has gone");
}

}  // namespace

absl::Status make_blocks(const Session& session, const Sample& sample, ViewCache& cache, const OnShort& on_short,
                         const std::atomic<bool>* cancel, const std::function<bool(v1::ResampleResponse)>& emit) {
  absl::StatusOr<SessionSampler> sampler = SessionSampler::open(session, sample, cache, SessionSampler::Wait::kForAll, cancel);
  if (!sampler.ok()) return sampler.status();
  if (sample.max_bytes > 0) {
    absl::StatusOr<Packed> packed = pack_within(*sampler, sample, static_cast<double>(sample.max_bytes));
    if (!packed.ok()) return packed.status();
    packed->sampled.statistics.set_refining(ask_for_better(packed->sampled, on_short));
    for (v1::PointBlock& block : packed->blocks) {
      const bool is_last = &block == &packed->blocks.back();
      const absl::Status status = emit_block(std::move(block), is_last ? &packed->sampled.statistics : nullptr, emit);
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  }
  const absl::StatusOr<std::uint64_t> wanted = sampler->points();
  if (!wanted.ok()) return wanted.status();
  absl::StatusOr<Sampled> sampled = sampler->sample(*wanted);
  if (!sampled.ok()) return sampled.status();
  sampled->statistics.set_refining(ask_for_better(*sampled, on_short));
  const std::size_t count = block_count(sampled->points().size());
  for (std::size_t first = 0; first < count; first += kBlocksAtOnce) {
    absl::StatusOr<std::vector<v1::PointBlock>> blocks =
        encode_blocks(*sampled, first, std::min(first + kBlocksAtOnce, count), sample);
    if (!blocks.ok()) return blocks.status();
    for (std::size_t b = 0; b < blocks->size(); ++b) {
      const bool is_last = first + b + 1 == count;
      const absl::Status status = emit_block(std::move((*blocks)[b]), is_last ? &sampled->statistics : nullptr, emit);
      if (!status.ok()) return status;
    }
  }
  return absl::OkStatus();
}

}  // namespace curvecast::server
