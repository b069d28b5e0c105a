#include "server/frame/point_blocks.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/frame/pack_points.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kBlocksAtOnce = 16;  // encoded before the first is sent

/// Hands over the messages of one point set.
class BlockEmitter {
 public:
  BlockEmitter(bool is_improving, const std::function<bool(v1::ResampleResponse)>& emit)
      : is_improving_(is_improving), emit_(emit) {}

  absl::Status emit(v1::PointBlock block, bool is_last, const PointSetStatistics& statistics) const {
    v1::ResampleResponse response;
    *response.mutable_points() = std::move(block);
    if (is_last) {
      *response.mutable_statistics() = to_proto(statistics);
      response.mutable_statistics()->set_refining(is_improving_);
    }
    return emit_(std::move(response)) ? absl::OkStatus() : absl::CancelledError("the client has gone");
  }

 private:
  const bool is_improving_;
  const std::function<bool(v1::ResampleResponse)>& emit_;
};

absl::Status emit_within(SessionSampler& sampler, const PointSetRequest& request, const ImprovementRequests& improvements,
                         const std::function<bool(v1::ResampleResponse)>& emit) {
  absl::StatusOr<Packed> packed = pack_within(sampler, request, static_cast<double>(request.max_bytes));
  if (!packed.ok()) return packed.status();
  const BlockEmitter emitter(request_improvement(packed->sampled, improvements), emit);
  for (v1::PointBlock& block : packed->blocks) {
    const bool is_last = &block == &packed->blocks.back();
    if (absl::Status status = emitter.emit(std::move(block), is_last, packed->sampled.statistics); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status emit_blocks(
    std::size_t points,
    const std::function<absl::StatusOr<std::vector<v1::PointBlock>>(std::size_t first, std::size_t last)>& encode,
    const PointSetStatistics& statistics, bool is_improving, const std::function<bool(v1::ResampleResponse)>& emit) {
  const BlockEmitter emitter(is_improving, emit);
  const std::size_t count = point_block_count(points);
  for (std::size_t first = 0; first < count; first += kBlocksAtOnce) {
    absl::StatusOr<std::vector<v1::PointBlock>> blocks = encode(first, std::min(first + kBlocksAtOnce, count));
    if (!blocks.ok()) return blocks.status();
    for (std::size_t b = 0; b < blocks->size(); ++b) {
      const bool is_last = first + b + 1 == count;
      if (absl::Status status = emitter.emit(std::move((*blocks)[b]), is_last, statistics); !status.ok()) return status;
    }
  }
  return absl::OkStatus();
}

absl::Status emit_point_blocks(Sampled& sampled, const PointSetRequest& request, bool is_improving,
                               const std::function<bool(v1::ResampleResponse)>& emit) {
  return emit_blocks(
      sampled.points().size(),
      [&](std::size_t first, std::size_t last) { return encode_point_blocks(sampled, first, last, request); }, sampled.statistics,
      is_improving, emit);
}

absl::Status make_point_blocks(const Session& session, const PointSetRequest& request, ViewCache& cache,
                               const ImprovementRequests& improvements, const ExecutionContext& context,
                               const std::function<bool(v1::ResampleResponse)>& emit) {
  absl::StatusOr<SessionSampler> sampler = SessionSampler::open(session, request, cache, SessionSampler::Wait::kForAll, context);
  if (!sampler.ok()) return sampler.status();
  if (request.max_bytes > 0) return emit_within(*sampler, request, improvements, emit);
  const absl::StatusOr<std::uint64_t> wanted = sampler->points();
  if (!wanted.ok()) return wanted.status();
  MemoryClaim claim(context);
  if (absl::Status status = claim_points(*wanted, claim); !status.ok()) return status;
  absl::StatusOr<Sampled> sampled = sampler->sample(*wanted);
  if (!sampled.ok()) return sampled.status();
  return emit_point_blocks(*sampled, request, request_improvement(*sampled, improvements), emit);
}

}  // namespace curvecast::server
