// How points that keep distances push one another.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

/// Points in columns, in blocks of neighbours, with boxes around the blocks and around groups of these.
class Repulsion {
 public:
  static constexpr std::size_t kBlock = 16;  // points

  /// Memory that find() uses again.
  struct Scratch {
    std::vector<std::uint32_t> near;              // blocks
    std::array<std::vector<float>, 3> low, high;  // of their boxes, by axis
    std::vector<float> spacing;                   // the largest in each
    std::vector<std::int32_t> is_near;            // to one point
  };

  explicit Repulsion(std::size_t points);

  std::size_t block_count() const { return x_.size() / kBlock; }
  /// Says where a point is. `spacing`: how far it keeps from others of its kind; `normal`: unit length, or zero where it has
  /// none: it faces as all others do.
  void set(std::size_t i, const Vec3f& position, const Vec3f& normal, float spacing);
  /// Has to be called once points have been set, before anything is asked for.
  void fill_boxes();
  /// Moves a point, without fill_boxes().
  void move(std::size_t i, const Vec3f& position, const Vec3f& normal);

  /// Finds how hard the points of a block are pushed, and where to: the sum of (1 - d / r)^2 over all points nearer than r, which
  /// is twice the smaller spacing of the two, d being the distance; less where normals differ by more than 90 degrees, nothing
  /// where by 120 or more: as neighbour_distances_on_side() has it. For any number of threads at a time.
  std::array<Vec3f, kBlock> find(std::size_t block, Scratch& scratch) const;

  /// How near others are: distances over the smaller spacing of the two; 2 where none is nearer.
  struct Nearest {
    float on_side = 2;  // of those that may push
    float at_all = 2;
  };
  /// Finds how near others would be to point i, if that were at a place.
  Nearest nearest(std::size_t i, const Vec3f& position, const Vec3f& normal, Scratch& scratch) const;

 private:
  struct Box {
    Vec3f low, high;
    float spacing;  // the largest
  };
  static constexpr std::size_t kFan = 8;  // boxes in a box

  /// Lists the blocks whose points may push those in a box.
  void list_near(const Box& around, std::vector<std::uint32_t>& near) const;
  void add_near(std::size_t level, std::size_t box, const Box& around, std::vector<std::uint32_t>& near) const;

  const std::size_t size_;
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, spacing_;  // filled up to whole blocks with points that push nobody
  std::vector<std::vector<Box>> boxes_;                    // by level, from the blocks' own up to a few
};

}  // namespace curvecast
