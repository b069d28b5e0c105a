// What the client of a stream holds, so that the next frame can be the difference to it.
#pragma once

#include <memory>
#include <optional>

#include "core/sample/rank_selection.h"
#include "server/convert.h"

namespace curvecast::server {

/// Ranked points as they were sent. Immutable: a stream keeps one from frame to frame.
struct HeldPoints {
  std::shared_ptr<const SurfaceCurve> curve;  // that has the ranks
  RankSelection selection;                    // with its tree and its discs, and no room for more
  std::optional<DracoOptions> draco;
  PointAttributes attributes;

  std::size_t byte_size() const {
    return selection.parts.size() * sizeof(RankSelection::Part) + selection.shown.size() * sizeof(std::uint64_t) +
           selection.rungs.size();
  }
};

/// Of a selection; chunks of which nothing is shown are left out.
std::shared_ptr<const HeldPoints> hold(const std::shared_ptr<const SurfaceCurve>& curve, const RankSelection& selection,
                                       const Sample& sample);

/// Whether points of this curve, sent as `sample` asks for, go with those held.
bool goes_with(const HeldPoints& held, const SurfaceCurve& curve, const Sample& sample);

}  // namespace curvecast::server
