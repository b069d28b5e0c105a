// What the client of a stream holds, so that the next frame can be the difference to it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/curve/surface_curve.h"
#include "core/progressive/rank_selection.h"
#include "server/convert/sample.h"

namespace curvecast::server {

/// Ranked points as they were sent. Immutable: a stream keeps one from frame to frame, so it has no room to spare: some 50 KiB
/// for 50,000 points.
class HeldPoints {
 public:
  HeldPoints() = default;  // none
  /// Of a selection from a curve with ranks.
  HeldPoints(std::shared_ptr<const SurfaceCurve> curve, const RankSelection& selection, const Sample& sample);

  /// Without its discs, and without the chunks of which nothing is shown.
  const RankSelection& selection() const { return selection_; }
  /// The discs, for selection().rungs.
  void discs(std::vector<std::uint8_t>& rungs) const;
  /// Names the points, their discs and how they were sent to a client; never 0.
  std::uint64_t digest() const { return digest_; }
  /// Whether points of this curve, sent as `sample` asks for, go with these.
  bool goes_with(const SurfaceCurve& curve, const Sample& sample) const;

  std::size_t byte_size() const;

 private:
  /// Discs one after the other that are alike.
  struct Run {
    std::uint8_t rung, count;
  };

  void keep_runs(std::span<const std::uint8_t> rungs);

  std::shared_ptr<const SurfaceCurve> curve_;
  RankSelection selection_;
  std::vector<Run> discs_;
  std::optional<DracoOptions> draco_;
  PointAttributes attributes_;
  std::uint64_t digest_ = 0;
};

}  // namespace curvecast::server
