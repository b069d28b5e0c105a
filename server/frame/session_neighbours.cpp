#include "server/frame/session_neighbours.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <utility>

#include "server/base/protocol.h"
#include "server/frame/pack_points.h"
#include "server/frame/point_blocks.h"

namespace curvecast::server {
namespace {

absl::Status too_many(std::uint64_t points, std::uint64_t length) {
  return absl::OutOfRangeError(absl::StrCat("count: ", points, " points with ", length, " neighbours each have ", points * length,
                                            "; at most ", kMaxNeighbourPairs, " are found: ask for fewer of either"));
}

}  // namespace

absl::Status find_neighbours(const Session& session, const PointSetRequest& request, const NeighbourSearch& search,
                             ViewCache& cache, const ImprovementRequests& improvements, const ExecutionContext& context,
                             const NeighbourChunks::Emit& emit) {
  absl::StatusOr<SessionSampler> sampler = SessionSampler::open(session, request, cache, SessionSampler::Wait::kForAll, context);
  if (!sampler.ok()) return sampler.status();
  const absl::StatusOr<std::uint64_t> wanted = sampler->points();
  if (!wanted.ok()) return wanted.status();
  const std::uint64_t length = std::min<std::uint64_t>(search.count, std::max<std::uint64_t>(*wanted, 1) - 1);
  if (*wanted <= kMaxPoints && *wanted * length > kMaxNeighbourPairs) return too_many(*wanted, length);
  MemoryClaim claim(context);
  if (absl::Status status = claim_points(*wanted, claim); !status.ok()) return status;
  absl::StatusOr<Sampled> sampled = sampler->sample(*wanted);
  if (!sampled.ok()) return sampled.status();
  const auto emit_points = [&](v1::ResampleResponse points) {
    v1::FindNeighboursResponse response;
    *response.mutable_points() = std::move(points);
    return emit(std::move(response));
  };
  const bool is_improving = request_improvement(*sampled, improvements);
  if (absl::Status status = emit_point_blocks(*sampled, request, is_improving, emit_points); !status.ok()) return status;

  const absl::StatusOr<NeighbourTree> tree = NeighbourTree::build(sampled->points().positions, context);
  if (!tree.ok()) return tree.status();
  NeighbourChunks chunks(emit);
  const auto take = [&](const NeighbourLists& lists) { return chunks.add(lists); };
  absl::Status status;
  if (search.count > 0) {
    status = list_nearest(*tree, search.count, context, take);
  } else {
    constexpr double kAll = 1e18;  // farther than any mesh may reach; its square is a float
    const double radius = std::min(search.radius, kAll);
    status = list_within(*tree, static_cast<float>(radius * radius), kMaxNeighbourPairs, context, take);
    if (absl::IsOutOfRange(status)) {
      return absl::OutOfRangeError(absl::StrCat("radius is ", search.radius, ": ", status.message(), "; ask for a smaller one"));
    }
  }
  if (!status.ok()) return status;
  return chunks.finish() ? absl::OkStatus() : absl::CancelledError("the client has gone");
}

}  // namespace curvecast::server
