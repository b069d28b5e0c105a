#include "server/frame/make_frame.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/stopwatch.h"
#include "core/codec/position_bits.h"
#include "core/progressive/sample_ranked.h"
#include "server/base/protocol.h"
#include "server/convert/convert_points.h"
#include "server/frame/pack_points.h"
#include "server/frame/view_lattice.h"

namespace curvecast::server {
namespace {

// What a delta costs: points that lie farther apart predict each other worse, by half a bit of each coordinate for every
// doubling; and each change is written down.
constexpr double kBytesPerDoubling = 3 * 0.5 / 8, kEditBytes = 1.1;
// A part after the first one brings up to so many times as many points as there are.
constexpr std::uint64_t kPartGrowth = 4;

struct PackedFrame {
  Packed packed;
  std::optional<v1::PointEdits> edits;  // set: the blocks are points that these edits add
  bool is_part = false;                 // the view has more points
};

absl::Status too_large(std::size_t bytes) {
  return absl::ResourceExhaustedError(absl::StrCat("the frame would have ", bytes, " bytes; at most ", kMaxFrameBytes,
                                                   " are sent: ask for fewer points or fewer bits, or use Resample"));
}

absl::StatusOr<PackedFrame> pack_key(Sampled sampled, const PointSetRequest& request) {
  const std::size_t least = sampled.points().size() * least_point_bytes(*sampled.curve, request);
  if (least > kMaxFrameBytes) return too_large(least);  // before there is memory for it
  absl::StatusOr<Packed> packed = pack(std::move(sampled), request);
  if (!packed.ok()) return packed.status();
  if (packed->bytes > kMaxFrameBytes) return too_large(packed->bytes);
  return PackedFrame{*std::move(packed), {}, false};
}

absl::StatusOr<PackedFrame> pack_sampled(SessionSampler& sampler, const PointSetRequest& request, std::uint64_t points) {
  absl::StatusOr<Sampled> sampled = sampler.sample(points);
  if (!sampled.ok()) return sampled.status();
  return pack_key(*std::move(sampled), request);
}

absl::StatusOr<PackedFrame> pack_bytes(SessionSampler& sampler, const PointSetRequest& request) {
  const std::uint64_t limit = std::min<std::uint64_t>(request.max_bytes, kMaxFrameBytes);
  absl::StatusOr<Packed> packed = pack_within(sampler, request, static_cast<double>(limit));
  if (!packed.ok()) return packed.status();
  return PackedFrame{*std::move(packed), {}, false};
}

/// Selects the ranked points of a part, or of the whole view where it has no more than those of the part: then the discs are
/// those of the whole, and so are the chunks that it lacks.
absl::StatusOr<Sampled> select_part(SessionSampler& sampler, std::uint64_t part, std::uint64_t whole) {
  {
    absl::StatusOr<Sampled> selected = sampler.select(part, whole);
    if (!selected.ok() || part == whole || selected->workspace->ranked.selection.count == part) return selected;
  }
  return sampler.select(whole, whole);
}

absl::StatusOr<PackedFrame> pack_selected(Sampled selected, const PointSetRequest& request) {
  SessionSampler::list(selected, request.attributes);
  return pack_key(std::move(selected), request);
}

/// Packs the difference to what the client holds, or all points where these take fewer bytes.
absl::StatusOr<PackedFrame> pack_delta(Sampled selected, const PointSetRequest& request, const ReferenceFrame& reference) {
  RankedWorkspace& workspace = selected.workspace->ranked;
  const RankSelection& selection = workspace.selection;
  RankDelta& delta = workspace.delta;
  Stopwatch watch;
  reference.discs(workspace.discs);
  compare(reference.selection(), workspace.discs, selection, delta);
  const double point_bytes = expected_point_bytes(*selected.curve, request, selected.lattice.bits);
  const auto count = static_cast<double>(selection.count), added = static_cast<double>(delta.added.size());
  const double scattered = point_bytes + kBytesPerDoubling * std::log2(count / std::max(added, 1.0));
  const double changes = added + static_cast<double>(delta.removed.size() + delta.resized.size());
  if (scattered * added + kEditBytes * changes > point_bytes * count) {
    return pack_selected(std::move(selected), request);
  }
  selected.lattice = delta.added.empty() ? reference.lattice() : selected.need.beside(reference.lattice());
  locate(reference.selection(), selection, delta, workspace.list_delta);
  gather_ranked(*selected.curve, selection, delta.added, workspace.points, request.attributes.need_places());
  v1::PointEdits edits = to_proto(delta, workspace.list_delta, *selected.curve);
  selected.statistics.equalise_seconds += watch.lap();
  if (delta.added.empty()) return PackedFrame{{std::move(selected), {}, 0}, std::move(edits), false};
  absl::StatusOr<PackedFrame> out = pack_key(std::move(selected), request);
  if (out.ok()) out->edits = std::move(edits);
  return out;
}

/// Packs as many points as the view's budget allows, or the next part of them. Errors as of make_frame().
absl::StatusOr<PackedFrame> pack_view(SessionSampler& sampler, const FrameRequest& request, const ReferenceFrame* reference) {
  const PointSetRequest& point_set = request.point_set;
  const absl::StatusOr<std::uint64_t> whole = sampler.points();
  if (!whole.ok()) return whole.status();
  std::uint64_t part = *whole;
  if (request.first_bytes > 0 && sampler.is_ranked()) {
    const int bits = reference != nullptr ? reference->lattice().bits : kPlainPositionBits;
    const double first = static_cast<double>(request.first_bytes) / expected_point_bytes(sampler.curve(), point_set, bits);
    const std::uint64_t more = reference != nullptr ? kPartGrowth * reference->selection().count : 0;
    part = std::min(*whole, std::max(more, static_cast<std::uint64_t>(std::max(first, 1.0))));
  }
  MemoryClaim claim(request.context);
  if (absl::Status status = claim_points(part, claim); !status.ok()) return status;
  const std::size_t least_bytes = least_point_bytes(sampler.curve(), point_set);
  if (reference == nullptr && !point_set.draco && part <= kMaxPoints && part > kMaxFrameBytes / least_bytes) {
    return too_large(part * least_bytes);
  }
  if (!sampler.is_ranked()) return pack_sampled(sampler, point_set, *whole);
  absl::StatusOr<Sampled> selected = select_part(sampler, part, *whole);
  if (!selected.ok()) return selected.status();
  const bool is_part = part < *whole && selected->workspace->ranked.selection.count == part;
  const bool has_delta = reference != nullptr && selected->need.is_met_by(reference->lattice());
  absl::StatusOr<PackedFrame> packed =
      has_delta ? pack_delta(*std::move(selected), point_set, *reference) : pack_selected(*std::move(selected), point_set);
  if (packed.ok() && is_part) {
    packed->is_part = true;
    packed->packed.sampled.statistics.wanted_points = *whole;
    packed->packed.sampled.statistics.limit = PointLimit::kComing;
  }
  return packed;
}

/// Returns what follows a frame, and asks for what the frame lacks. Where candidates lack and are being made, the next part waits
/// for them.
FollowUp follow_up_of(const PackedFrame& made, const FrameRequest& request, const ImprovementRequests& improvements) {
  if (request.may_refine && request_improvement(made.packed.sampled, improvements)) return FollowUp::kAfterImprovement;
  return made.is_part ? FollowUp::kNextPart : FollowUp::kNone;
}

}  // namespace

absl::StatusOr<Answer> make_frame(const Session& session, const FrameRequest& request, ViewCache& cache,
                                  const ImprovementRequests& improvements) {
  const PointSetRequest& point_set = request.point_set;
  absl::StatusOr<SessionSampler> sampler =
      SessionSampler::open(session, point_set, cache, SessionSampler::Wait::kForFirst, request.context);
  if (!sampler.ok()) return sampler.status();
  const bool may_differ =
      request.reference != nullptr && sampler->is_ranked() && request.reference->goes_with(sampler->curve(), point_set);
  if (may_differ) sampler->expect_scale(request.reference->selection().similar_scale());
  absl::StatusOr<PackedFrame> made = point_set.max_bytes > 0
                                         ? pack_bytes(*sampler, point_set)
                                         : pack_view(*sampler, request, may_differ ? request.reference : nullptr);
  if (!made.ok()) return made.status();
  Answer answer;
  answer.follow_up = follow_up_of(*made, request, improvements);
  Sampled& sampled = made->packed.sampled;
  if (sampled.statistics.limit == PointLimit::kComing && answer.follow_up == FollowUp::kNone) {
    sampled.statistics.limit = PointLimit::kServer;
  }
  v1::PointFrame& frame = answer.frame;
  frame.set_curve_revision(sampled.curve->revision);
  frame.set_kind(made->edits ? v1::FRAME_KIND_DELTA : v1::FRAME_KIND_KEY);
  if (made->edits) *frame.mutable_edits() = *std::move(made->edits);
  for (v1::PointBlock& block : made->packed.blocks) *frame.add_points() = std::move(block);
  *frame.mutable_statistics() = to_proto(sampled.statistics);
  if (sampled.is_ranked) {
    const RankSelection& selection = sampled.workspace->ranked.selection;
    frame.set_held_points(selection.count);
    ViewLattice held = sampled.lattice;
    if (made->edits) held.bits = std::min(held.bits, request.reference->lattice().bits);
    answer.reference = std::make_shared<const ReferenceFrame>(sampled.curve, selection, point_set, held);
    frame.set_digest(answer.reference->digest());
  } else {
    frame.set_held_points(sampled.points().size());
  }
  return answer;
}

absl::StatusOr<std::shared_ptr<const ReferenceFrame>> restore_reference(const Session& session, const ResumeClaim& claim,
                                                                        ViewCache& cache, const ExecutionContext& context) {
  absl::StatusOr<SessionSampler> sampler =
      SessionSampler::open(session, claim.point_set, cache, SessionSampler::Wait::kForFirst, context);
  if (!sampler.ok()) return sampler.status();
  if (!sampler->is_ranked()) return nullptr;
  const absl::StatusOr<Sampled> selected = sampler->select(claim.points, claim.points);
  if (!selected.ok()) return selected.status();
  if (selected->lacks_ranks) return nullptr;
  const auto on = [&](const ViewLattice& lattice) {
    return std::make_shared<const ReferenceFrame>(selected->curve, selected->workspace->ranked.selection, claim.point_set,
                                                  lattice);
  };
  auto reference = on(selected->lattice);
  // The client may have come to the view with other bits than it needs.
  for (int bits = kLeastPositionBits; reference->digest() != claim.digest && bits <= kMostCornerBits; ++bits) {
    const ViewLattice other{.bits = bits, .centre = {}};
    if (selected->need.is_met_by(other)) reference = on(other);
  }
  return reference->digest() == claim.digest ? reference : nullptr;
}

}  // namespace curvecast::server
