#include "server/point_blocks.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "core/sample/sample_ranked.h"
#include "core/stopwatch.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kRawPointBytes = 2 * sizeof(Vec3f) + sizeof(float);
constexpr std::size_t kRawColourBytes = 3;

// Encoding within a number of bytes: the first guess is off by what the view and the mesh make of a point, the second hardly.
constexpr int kMaxRounds = 4;
constexpr double kAim = 0.96, kGoodEnough = 0.9;  // of the budget

// What a delta costs: points that lie far apart predict each other badly, and each change is written down.
constexpr double kScatteredPoint = 1.5, kEditBytes = 1.1;

void ask_for_better(Sampled& sampled, const OnShort& on_short) {
  const bool is_finer = sampled.is_short && on_short.finer_curve && on_short.finer_curve(*sampled.curve, sampled.points().size());
  const bool is_more = !sampled.lacking().empty() && on_short.more_ranks && on_short.more_ranks(sampled.lacking());
  sampled.statistics.set_refining(is_finer || is_more);
}

// Adds the time that it takes to the statistics.
absl::StatusOr<v1::PointBlock> encode(Sampled& sampled, std::size_t begin, std::size_t count, const Sample& sample) {
  Stopwatch watch;
  absl::StatusOr<v1::PointBlock> block = to_proto(sampled.points(), begin, count, *sampled.curve, sample.draco);
  const PointAttributes& wanted = sample.attributes;
  if (block.ok() && (wanted.curvatures || wanted.rank || wanted.surface)) {
    *block->mutable_attributes() = to_proto(sampled.points(), begin, count, *sampled.curve, wanted);
  }
  sampled.statistics.set_encode_seconds(sampled.statistics.encode_seconds() + watch.lap());
  return block;
}

std::size_t raw_point_bytes(const SurfaceCurve& curve) { return kRawPointBytes + (curve.colour.empty() ? 0 : kRawColourBytes); }

std::size_t data_bytes(const v1::PointBlock& block) {
  const v1::RawPoints& raw = block.raw();
  const v1::PointAttributes& more = block.attributes();
  return more.curvatures().size() + more.ranks().size() + more.faces().size() + more.barycentric().size() +
         block.draco().data().size() + raw.positions().size() + raw.normals().size() + raw.radii().size() + raw.colours().size();
}

/// What a point takes, roughly; neighbours differ little, so that about half of a position's bits are left.
double expected_point_bytes(const SurfaceCurve& curve, const Sample& sample) {
  const double more =
      (sample.attributes.curvatures ? 8 : 0) + (sample.attributes.rank ? 4 : 0) + (sample.attributes.surface ? 12 : 0);
  if (!sample.draco) return more + static_cast<double>(raw_point_bytes(curve));
  return more + (1.4 * sample.draco->position_bits + sample.draco->normal_bits + 1) / 8 +
         (curve.colour.empty() ? 0 : kRawColourBytes);
}

struct Packed {
  Sampled sampled;
  std::vector<v1::PointBlock> blocks;
  std::size_t bytes = 0;
  std::optional<v1::PointEdits> edits;  // with which they are to be taken in
};

absl::StatusOr<Packed> pack(Sampled sampled, const Sample& sample, std::size_t block_points) {
  Packed out{std::move(sampled), {}, 0, {}};
  const std::size_t total = out.sampled.points().size();
  for (std::size_t begin = 0; begin < total; begin += block_points) {
    absl::StatusOr<v1::PointBlock> block = encode(out.sampled, begin, std::min(block_points, total - begin), sample);
    if (!block.ok()) return block.status();
    out.bytes += data_bytes(*block);
    out.blocks.push_back(*std::move(block));
  }
  if (total == 0) out.blocks.emplace_back().mutable_raw();  // nothing yet: better frames follow
  return out;
}

/// As many points as `limit` bytes hold, in blocks of `block_points`.
absl::StatusOr<Packed> pack_within(SessionSampler& sampler, const Sample& sample, std::size_t block_points, double limit) {
  const auto whole = [](double points) {
    return static_cast<std::uint64_t>(std::clamp(points, 1.0, static_cast<double>(kMaxPoints)));
  };
  std::optional<Packed> best;
  std::uint64_t count = whole((sample.draco ? kAim : 1) * limit / expected_point_bytes(sampler.curve(), sample));
  for (int round = 1;; ++round) {
    absl::StatusOr<Sampled> sampled = sampler.sample(count);
    if (!sampled.ok()) return sampled.status();
    absl::StatusOr<Packed> packed = pack(*std::move(sampled), sample, block_points);
    if (!packed.ok()) return packed.status();
    const auto bytes = static_cast<double>(packed->bytes);
    const bool fits = bytes <= limit;
    if (fits && (!best || packed->bytes > best->bytes)) best = *std::move(packed);
    const bool is_done = fits && (bytes >= kGoodEnough * limit || count == kMaxPoints || !sample.draco);
    if (best && (is_done || round >= kMaxRounds)) return *std::move(best);
    if (!fits && count == 1) return absl::ResourceExhaustedError("sample.max_bytes does not hold a single point");
    const std::uint64_t next = whole(kAim * static_cast<double>(count) * limit / bytes);
    count = fits ? std::max(next, count + 1) : round < kMaxRounds ? std::min(next, count - 1) : count / 2;
  }
}

absl::Status too_large(std::size_t bytes) {
  return absl::ResourceExhaustedError(absl::StrCat("the frame would have ", bytes, " bytes; at most ", kMaxFrameBytes,
                                                   " are sent: ask for fewer points or fewer bits, or use Resample"));
}

absl::StatusOr<Packed> pack_key(Sampled sampled, const Sample& sample) {
  absl::StatusOr<Packed> packed = pack(std::move(sampled), sample, kMaxPoints);
  if (packed.ok() && packed->bytes > kMaxFrameBytes) return too_large(packed->bytes);
  return packed;
}

/// All points in one block.
absl::StatusOr<Packed> pack_frame(SessionSampler& sampler, const Sample& sample) {
  if (sample.max_bytes > 0) {
    const std::uint64_t limit = std::min<std::uint64_t>(sample.max_bytes, kMaxFrameBytes);
    return pack_within(sampler, sample, kMaxPoints, static_cast<double>(limit));
  }
  const absl::StatusOr<std::uint64_t> count = sampler.points();
  if (!count.ok()) return count.status();
  const std::size_t raw_bytes = raw_point_bytes(sampler.curve());
  if (!sample.draco && *count <= kMaxPoints && *count > kMaxFrameBytes / raw_bytes) return too_large(*count * raw_bytes);
  absl::StatusOr<Sampled> sampled = sampler.sample(*count);
  if (!sampled.ok()) return sampled.status();
  return pack_key(*std::move(sampled), sample);
}

/// The difference to what the client has, or all points where that is smaller.
absl::StatusOr<Packed> pack_delta(SessionSampler& sampler, const Sample& sample, const HeldPoints& held) {
  const absl::StatusOr<std::uint64_t> count = sampler.points();
  if (!count.ok()) return count.status();
  absl::StatusOr<Sampled> selected = sampler.select(*count);
  if (!selected.ok()) return selected.status();
  ResampleWorkspace& workspace = *selected->workspace;
  const RankSelection& selection = workspace.selection;
  RankDelta& delta = workspace.delta;
  Stopwatch watch;
  compare(held.selection, selection, delta);
  const double point_bytes = expected_point_bytes(*selected->curve, sample);
  const auto changes = static_cast<double>(delta.added.size() + delta.removed.size() + delta.resized.size());
  const double delta_bytes = kScatteredPoint * point_bytes * static_cast<double>(delta.added.size()) + kEditBytes * changes;
  if (delta_bytes > point_bytes * static_cast<double>(selection.count)) {
    SessionSampler::list(*selected);
    return pack_key(*std::move(selected), sample);
  }
  locate(held.selection, selection, delta, workspace.list_delta);
  gather_ranked(*selected->curve, *selection.tree, delta.added, workspace.points);
  v1::PointEdits edits = to_proto(delta, workspace.list_delta, *selected->curve);
  selected->statistics.set_equalise_seconds(selected->statistics.equalise_seconds() + watch.lap());
  Packed out{*std::move(selected), {}, 0, std::move(edits)};
  if (!delta.added.empty()) {
    absl::StatusOr<v1::PointBlock> block = encode(out.sampled, 0, delta.added.size(), sample);
    if (!block.ok()) return block.status();
    out.bytes = data_bytes(*block);
    out.blocks.push_back(*std::move(block));
  }
  return out;
}

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
    absl::StatusOr<Packed> packed = pack_within(*sampler, sample, kBlockPoints, static_cast<double>(sample.max_bytes));
    if (!packed.ok()) return packed.status();
    ask_for_better(packed->sampled, on_short);
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
  ask_for_better(*sampled, on_short);
  const std::size_t total = sampled->points().size();
  for (std::size_t begin = 0; begin < total; begin += kBlockPoints) {
    const std::size_t count = std::min(kBlockPoints, total - begin);
    absl::StatusOr<v1::PointBlock> block = encode(*sampled, begin, count, sample);
    if (!block.ok()) return block.status();
    const bool is_last = begin + count == total;
    const absl::Status status = emit_block(*std::move(block), is_last ? &sampled->statistics : nullptr, emit);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<Answer> make_frame(const Session& session, const Sample& sample, const HeldPoints* held, ViewCache& cache,
                                  const OnShort& on_short) {
  absl::StatusOr<SessionSampler> sampler = SessionSampler::open(session, sample, cache, SessionSampler::Wait::kForFirst);
  if (!sampler.ok()) return sampler.status();
  const bool has_delta =
      held != nullptr && sampler->is_ranked() && sample.max_bytes == 0 && goes_with(*held, sampler->curve(), sample);
  absl::StatusOr<Packed> packed = has_delta ? pack_delta(*sampler, sample, *held) : pack_frame(*sampler, sample);
  if (!packed.ok()) return packed.status();
  Sampled& sampled = packed->sampled;
  ask_for_better(sampled, on_short);
  Answer answer;
  v1::PointFrame& frame = answer.frame;
  frame.set_curve_revision(sampled.curve->revision);
  frame.set_kind(packed->edits ? v1::FRAME_KIND_DELTA : v1::FRAME_KIND_KEY);
  if (packed->edits) *frame.mutable_edits() = *std::move(packed->edits);
  if (!packed->blocks.empty()) *frame.mutable_points() = std::move(packed->blocks.front());
  *frame.mutable_statistics() = std::move(sampled.statistics);
  if (sampler->is_ranked()) {
    const RankSelection& selection = sampled.workspace->selection;
    frame.set_held_points(selection.count);
    answer.held = hold(sampled.curve, selection, sample);
  } else {
    frame.set_held_points(sampled.points().size());
  }
  return answer;
}

}  // namespace curvecast::server
