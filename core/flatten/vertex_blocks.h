// Blocks of a mesh's vertices that can lose some side by side, and what lies at the seams between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

class VertexHierarchy;

/// Of the vertices that a hierarchy still has. A collapse changes and asks for nothing beyond the neighbours' neighbours: so what
/// is away from the seams can go block by block, on any thread. Deterministic.
class VertexBlocks {
 public:
  enum Seam : std::uint8_t { kAway, kNear, kOn };  // kNear: beside one that is kOn; kOn: beside one of another block

  /// Blocks to divide so many vertices into: a power of two, 1 where division is not worth its while.
  static std::uint32_t wanted(std::size_t vertices);

  std::uint32_t count() const { return count_; }
  bool is_away(std::uint32_t v) const { return seam_[v] == kAway; }
  Seam seam(std::uint32_t v) const { return seam_[v]; }
  std::uint32_t block(std::uint32_t v) const { return block_[v]; }

  /// Makes that many blocks of the hierarchy's base, or joins those that there are until there are so many.
  void set_count(std::uint32_t count, const VertexHierarchy& hierarchy, std::span<const Vec3d> positions);
  /// Brings what is known of seams up to date around u, which has new neighbours.
  void spread_seams(std::uint32_t u, const VertexHierarchy& hierarchy);

 private:
  void divide(std::uint32_t count, std::span<const std::uint32_t> vertices, std::span<const Vec3d> positions);
  void find_seams(const VertexHierarchy& hierarchy);

  std::vector<std::uint8_t> block_;  // per vertex of the mesh, as is the next
  std::vector<Seam> seam_;
  std::uint32_t count_ = 1;
};

}  // namespace curvecast
