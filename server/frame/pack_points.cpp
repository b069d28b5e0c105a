#include "server/frame/pack_points.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/base/stopwatch.h"
#include "core/codec/position_bits.h"
#include "server/convert/convert_points.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kRawPointBytes = 2 * sizeof(Vec3f) + sizeof(float);
constexpr std::size_t kRawColourBytes = 3;

// Encoding within a number of bytes: the first guess is off by what the view and the mesh make of a point, the second hardly.
constexpr int kMaxRounds = 6;
constexpr double kAim = 0.96, kGoodEnough = 0.9;  // of the budget

std::size_t data_bytes(const v1::PointBlock& block) {
  const v1::RawPoints& raw = block.raw();
  const v1::PointAttributes& more = block.attributes();
  std::size_t bytes =
      more.curvatures().size() + more.ranks().size() + more.faces().size() + more.barycentric().size() + more.directions().size();
  for (const v1::ScalarValues& scalar : more.scalars()) bytes += scalar.values().size();
  return bytes + block.draco().data().size() + raw.positions().size() + raw.normals().size() + raw.radii().size() +
         raw.colours().size();
}

/// Points [begin, begin + count) as one block with the attributes asked for.
absl::StatusOr<v1::PointBlock> encode(const Sampled& sampled, std::size_t begin, std::size_t count,
                                      const PointSetRequest& request) {
  absl::StatusOr<v1::PointBlock> block =
      to_proto(sampled.points(), begin, count, sampled.curve->box, draco_options(request, sampled.lattice));
  if (block.ok() && request.attributes != PointAttributes()) {
    *block->mutable_attributes() =
        to_proto(sampled.points(), begin, count, *sampled.curve, sampled.surface.get(), request.attributes);
  }
  return block;
}

}  // namespace

double expected_point_bytes(const SurfaceCurve& curve, const PointSetRequest& request, int position_bits) {
  const auto least = static_cast<double>(least_point_bytes(curve, request));
  if (!request.draco) return least;
  return least + (1.4 * position_bits + request.draco->normal_bits + 1) / 8 + (curve.colour.empty() ? 0 : kRawColourBytes);
}

std::size_t least_point_bytes(const SurfaceCurve& curve, const PointSetRequest& request) {
  const PointAttributes& wanted = request.attributes;
  const std::size_t attributes = (wanted.curvatures ? 8 : 0) + (wanted.rank ? 4 : 0) + (wanted.surface ? 12 : 0) +
                                 (wanted.directions ? 12 : 0) + (wanted.scalars ? 4 * curve.scalars.size() : 0);
  if (request.draco) return attributes;
  return attributes + kRawPointBytes + (curve.colour.empty() ? 0 : kRawColourBytes);
}

absl::StatusOr<std::vector<v1::PointBlock>> encode_blocks(
    std::size_t points, std::size_t first, std::size_t last,
    const std::function<absl::StatusOr<v1::PointBlock>(std::size_t begin, std::size_t count)>& encode) {
  const std::size_t count = point_block_count(points);
  std::vector<absl::StatusOr<v1::PointBlock>> encoded(last - first, absl::UnknownError(""));
  tbb::parallel_for(first, last, [&](std::size_t b) {
    const std::size_t begin = b * points / count;
    encoded[b - first] = encode(begin, (b + 1) * points / count - begin);
  });
  std::vector<v1::PointBlock> blocks;
  for (absl::StatusOr<v1::PointBlock>& block : encoded) {
    if (!block.ok()) return block.status();
    blocks.push_back(*std::move(block));
  }
  return blocks;
}

absl::StatusOr<std::vector<v1::PointBlock>> encode_point_blocks(Sampled& sampled, std::size_t first, std::size_t last,
                                                                const PointSetRequest& request) {
  Stopwatch watch;
  move_origin(sampled.lattice, sampled.points());
  absl::StatusOr<std::vector<v1::PointBlock>> blocks =
      encode_blocks(sampled.points().size(), first, last,
                    [&](std::size_t begin, std::size_t count) { return encode(sampled, begin, count, request); });
  if (!blocks.ok()) return blocks;
  if (sampled.surface != nullptr) {
    if (absl::Status damaged = sampled.surface->status(); !damaged.ok()) return damaged;
  }
  sampled.statistics.encode_seconds += watch.lap();
  return blocks;
}

absl::StatusOr<Packed> pack(Sampled sampled, const PointSetRequest& request) {
  Packed out{std::move(sampled), {}, 0};
  absl::StatusOr<std::vector<v1::PointBlock>> blocks =
      encode_point_blocks(out.sampled, 0, point_block_count(out.sampled.points().size()), request);
  if (!blocks.ok()) return blocks.status();
  for (const v1::PointBlock& block : *blocks) out.bytes += data_bytes(block);
  out.blocks = *std::move(blocks);
  if (out.blocks.empty()) out.blocks.emplace_back().mutable_raw();  // nothing yet: better frames follow
  return out;
}

absl::StatusOr<Packed> pack_within(SessionSampler& sampler, const PointSetRequest& request, double limit) {
  const auto whole = [](double points) {
    return static_cast<std::uint64_t>(std::clamp(points, 1.0, static_cast<double>(kMaxPoints)));
  };
  std::optional<Packed> best;
  std::uint64_t count =
      whole((request.draco ? kAim : 1) * limit / expected_point_bytes(sampler.curve(), request, kPlainPositionBits));
  for (int round = 1;; ++round) {
    absl::StatusOr<Sampled> sampled = sampler.sample(count);
    if (!sampled.ok()) return sampled.status();
    absl::StatusOr<Packed> packed = pack(*std::move(sampled), request);
    if (!packed.ok()) return packed.status();
    const auto bytes = static_cast<double>(packed->bytes);
    const bool fits = bytes <= limit;
    if (fits && (!best || packed->bytes > best->bytes)) best = *std::move(packed);
    const bool is_done = fits && (bytes >= kGoodEnough * limit || count == kMaxPoints || !request.draco);
    if (best && (is_done || round >= kMaxRounds)) {
      PointSetStatistics& statistics = best->sampled.statistics;
      if (statistics.limit == PointLimit::kNone && statistics.wanted_points < kMaxPoints) statistics.limit = PointLimit::kBytes;
      statistics.wanted_points = 0;
      return *std::move(best);
    }
    if (!fits && count == 1) return absl::ResourceExhaustedError("sample.max_bytes does not hold a single point");
    const std::uint64_t next = whole(kAim * static_cast<double>(count) * limit / bytes);
    count = fits ? std::max(next, count + 1) : round < kMaxRounds ? std::min(next, count - 1) : count / 2;
  }
}

bool request_improvement(const Sampled& sampled, const ImprovementRequests& improvements) {
  const bool is_finer =
      sampled.is_coarse && improvements.finer_curve && improvements.finer_curve(*sampled.curve, sampled.points().size());
  const bool is_more = sampled.lacks_ranks && improvements.more_ranks && improvements.more_ranks(sampled.demand);
  return is_finer || is_more;
}

}  // namespace curvecast::server
