#include "server/frame/make_frame.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/stopwatch.h"
#include "core/progressive/sample_ranked.h"
#include "server/convert/convert_points.h"
#include "server/frame/pack_points.h"

namespace curvecast::server {
namespace {

// What a delta costs: points that lie farther apart predict each other worse, by half a bit of each coordinate for every
// doubling; and each change is written down.
constexpr double kBytesPerDoubling = 3 * 0.5 / 8, kEditBytes = 1.1;
// A part after the first one brings up to so many times as many points as there are.
constexpr std::uint64_t kPartGrowth = 4;

struct PackedFrame {
  Packed packed;
  std::optional<v1::PointEdits> edits;  // with which the points are to be taken in
};

absl::Status too_large(std::size_t bytes) {
  return absl::ResourceExhaustedError(absl::StrCat("the frame would have ", bytes, " bytes; at most ", kMaxFrameBytes,
                                                   " are sent: ask for fewer points or fewer bits, or use Resample"));
}

absl::StatusOr<PackedFrame> pack_key(Sampled sampled, const Sample& sample) {
  absl::StatusOr<Packed> packed = pack(std::move(sampled), sample);
  if (!packed.ok()) return packed.status();
  if (packed->bytes > kMaxFrameBytes) return too_large(packed->bytes);
  return PackedFrame{*std::move(packed), {}};
}

absl::StatusOr<PackedFrame> pack_sampled(SessionSampler& sampler, const Sample& sample, std::uint64_t points) {
  absl::StatusOr<Sampled> sampled = sampler.sample(points);
  if (!sampled.ok()) return sampled.status();
  return pack_key(*std::move(sampled), sample);
}

absl::StatusOr<PackedFrame> pack_bytes(SessionSampler& sampler, const Sample& sample) {
  const std::uint64_t limit = std::min<std::uint64_t>(sample.max_bytes, kMaxFrameBytes);
  absl::StatusOr<Packed> packed = pack_within(sampler, sample, static_cast<double>(limit));
  if (!packed.ok()) return packed.status();
  return PackedFrame{*std::move(packed), {}};
}

/// Selects the ranked points of a part, or of the whole view where it has no more than those of the part: then the discs are
/// those of the whole, and so are the chunks that it lacks.
absl::StatusOr<Sampled> select_part(SessionSampler& sampler, std::uint64_t part, std::uint64_t whole) {
  {
    absl::StatusOr<Sampled> selected = sampler.select(part);
    if (!selected.ok() || part == whole || selected->workspace->ranked.selection.count == part) return selected;
  }
  return sampler.select(whole);
}

absl::StatusOr<PackedFrame> pack_selected(Sampled selected, const Sample& sample) {
  SessionSampler::list(selected);
  return pack_key(std::move(selected), sample);
}

/// The difference to what the client has, or all points where that is smaller.
absl::StatusOr<PackedFrame> pack_delta(Sampled selected, const Sample& sample, const HeldPoints& held) {
  RankedWorkspace& workspace = selected.workspace->ranked;
  const RankSelection& selection = workspace.selection;
  RankDelta& delta = workspace.delta;
  Stopwatch watch;
  held.discs(workspace.discs);
  compare(held.selection(), workspace.discs, selection, delta);
  const double point_bytes = expected_point_bytes(*selected.curve, sample);
  const auto count = static_cast<double>(selection.count), added = static_cast<double>(delta.added.size());
  const double scattered = point_bytes + kBytesPerDoubling * std::log2(count / std::max(added, 1.0));
  const double changes = added + static_cast<double>(delta.removed.size() + delta.resized.size());
  if (scattered * added + kEditBytes * changes > point_bytes * count) {
    return pack_selected(std::move(selected), sample);
  }
  locate(*held.selection().tree, selection, delta, workspace.list_delta);
  gather_ranked(*selected.curve, *selection.tree, delta.added, workspace.points);
  v1::PointEdits edits = to_proto(delta, workspace.list_delta, *selected.curve);
  selected.statistics.set_equalise_seconds(selected.statistics.equalise_seconds() + watch.lap());
  if (delta.added.empty()) return PackedFrame{{std::move(selected), {}, 0}, std::move(edits)};
  absl::StatusOr<PackedFrame> out = pack_key(std::move(selected), sample);
  if (out.ok()) out->edits = std::move(edits);
  return out;
}

}  // namespace

absl::StatusOr<Answer> make_frame(const Session& session, const FrameRequest& request, ViewCache& cache,
                                  const OnShort& on_short) {
  const Sample& sample = request.sample;
  absl::StatusOr<SessionSampler> sampler =
      SessionSampler::open(session, sample, cache, SessionSampler::Wait::kForFirst, request.cancel);
  if (!sampler.ok()) return sampler.status();
  const bool is_in_bytes = sample.max_bytes > 0;
  const HeldPoints* const held =
      request.held != nullptr && sampler->is_ranked() && !is_in_bytes && request.held->goes_with(sampler->curve(), sample)
          ? request.held
          : nullptr;
  Answer answer;
  absl::StatusOr<PackedFrame> made;
  bool is_part = false;
  if (is_in_bytes) {
    made = pack_bytes(*sampler, sample);
  } else {
    absl::StatusOr<std::uint64_t> points = sampler->points();
    if (!points.ok()) return points.status();
    std::uint64_t part = *points;
    if (request.first_bytes > 0 && sampler->is_ranked()) {
      const double first = static_cast<double>(request.first_bytes) / expected_point_bytes(sampler->curve(), sample);
      const std::uint64_t more = held != nullptr ? kPartGrowth * held->selection().count : 0;
      part = std::min(*points, std::max(more, static_cast<std::uint64_t>(std::max(first, 1.0))));
    }
    const std::size_t raw_bytes = raw_point_bytes(sampler->curve());
    if (held == nullptr && !sample.draco && part <= kMaxPoints && part > kMaxFrameBytes / raw_bytes) {
      return too_large(part * raw_bytes);
    }
    if (sampler->is_ranked()) {
      absl::StatusOr<Sampled> selected = select_part(*sampler, part, *points);
      if (!selected.ok()) return selected.status();
      is_part = part < *points && selected->workspace->ranked.selection.count == part;
      made = held != nullptr ? pack_delta(*std::move(selected), sample, *held) : pack_selected(*std::move(selected), sample);
    } else {
      made = pack_sampled(*sampler, sample, *points);
    }
  }
  if (!made.ok()) return made.status();
  Sampled& sampled = made->packed.sampled;
  // Where candidates lack and are being made, the next part waits for them.
  if (request.may_refine && ask_for_better(sampled, on_short)) {
    answer.follow_up = FollowUp::kAfterImprovement;
  } else if (is_part) {
    answer.follow_up = FollowUp::kNextPart;
  }
  v1::PointFrame& frame = answer.frame;
  frame.set_curve_revision(sampled.curve->revision);
  frame.set_kind(made->edits ? v1::FRAME_KIND_DELTA : v1::FRAME_KIND_KEY);
  if (made->edits) *frame.mutable_edits() = *std::move(made->edits);
  for (v1::PointBlock& block : made->packed.blocks) *frame.add_points() = std::move(block);
  *frame.mutable_statistics() = std::move(sampled.statistics);
  if (sampler->is_ranked()) {
    const RankSelection& selection = sampled.workspace->ranked.selection;
    frame.set_held_points(selection.count);
    answer.held = std::make_shared<const HeldPoints>(sampled.curve, selection, sample);
    frame.set_digest(answer.held->digest());
  } else {
    frame.set_held_points(sampled.points().size());
  }
  return answer;
}

absl::StatusOr<std::shared_ptr<const HeldPoints>> restore_held(const Session& session, const HeldClaim& claim, ViewCache& cache) {
  absl::StatusOr<SessionSampler> sampler = SessionSampler::open(session, claim.sample, cache, SessionSampler::Wait::kForAll);
  if (!sampler.ok()) return sampler.status();
  if (!sampler->is_ranked()) return nullptr;
  const absl::StatusOr<Sampled> selected = sampler->select(claim.points);
  if (!selected.ok()) return selected.status();
  auto held = std::make_shared<const HeldPoints>(selected->curve, selected->workspace->ranked.selection, claim.sample);
  return held->digest() == claim.digest ? held : nullptr;
}

}  // namespace curvecast::server
