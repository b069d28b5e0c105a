// The energy that the points of a full stratum group put on each other's candidates, beside that of an even distribution: where
// it is least, a point makes the whole most even. See point_energy.h for why.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/candidate_points.h"

namespace curvecast {

/// Knows the group alone: what lies around it is taken to be even. Keeps the address of the candidates. Immutable.
class GroupEnergy {
 public:
  /// `moves`: for each child whether its candidates will be asked for.
  GroupEnergy(const GroupCandidates& candidates, std::span<const std::uint8_t> moves);

  using Row = std::array<float, kCandidates>;
  /// Returns the energy of each candidate of child c, but for a constant. `points`: one for each child; that of c does not count.
  /// Precondition: c moves.
  Row of_candidates(std::size_t c, std::span<const RankedPoint> points) const;

 private:
  /// The other children around one: their energy on its candidates is worked out one by one, or, from farther away, by its slope
  /// at the middle of the candidates.
  struct Around {
    std::vector<std::uint32_t> near, far;
    Row expected;  // energy of an even distribution over this child and those around
  };

  const GroupCandidates& candidates_;
  float inverse_range_;
  std::vector<Around> around_;  // of each child
};

}  // namespace curvecast
