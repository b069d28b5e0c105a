// Points in columns, in blocks of such as follow one another, which find what is near.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/simd.h"
#include "core/base/vec.h"

namespace curvecast {

/// Has boxes around the blocks, and around groups of these. Quickest where points that follow one another are neighbours.
class PointBlocks {
 public:
  static constexpr std::size_t kBlock = 16;  // points

  struct Point {
    float x, y, z;
    float nx, ny, nz;  // unit length, or zero where it has none: it faces as all others do
    float spacing;     // how far it keeps from others of its kind
  };
  /// Of the points of a block, filled up to kBlock with some that are infinitely far away and have no spacing.
  struct Columns {
    const float *x, *y, *z, *nx, *ny, *nz, *spacing;
  };
  /// What list_near() has found, and memory that it uses again.
  struct Scratch {
    std::vector<std::uint32_t> near;              // blocks
    std::array<std::vector<float>, 3> low, high;  // of their boxes, by axis
    std::vector<float> spacing;                   // the largest in each
    std::vector<std::int32_t> is_near;            // to one point, as mark_near() has it
  };

  explicit PointBlocks(std::size_t points);

  std::size_t size() const { return size_; }
  std::size_t block_count() const { return x_.size() / kBlock; }
  std::size_t size_of(std::size_t block) const { return std::min(kBlock, size_ - block * kBlock); }
  Point point(std::size_t i) const { return {x_[i], y_[i], z_[i], nx_[i], ny_[i], nz_[i], spacing_[i]}; }
  Columns columns(std::size_t block) const {
    const std::size_t i = block * kBlock;
    return {&x_[i], &y_[i], &z_[i], &nx_[i], &ny_[i], &nz_[i], &spacing_[i]};
  }

  void set(std::size_t i, const Vec3f& position, const Vec3f& normal, float spacing);
  /// Has to be called once points have been set, before anything is asked for.
  void fill_boxes();
  /// Sets where a point is, without fill_boxes(): its boxes grow.
  void move(std::size_t i, const Vec3f& position, const Vec3f& normal);

  /// At first around nothing, with no spacing.
  struct Box {
    Vec3f low = Vec3f::Constant(kFarAway), high = Vec3f::Constant(-kFarAway);
    float spacing = 0;  // the largest

    void extend(const Box& other) {
      low = low.cwiseMin(other.low);
      high = high.cwiseMax(other.high);
      spacing = std::max(spacing, other.spacing);
    }
    void extend(const Point& point) {
      const Vec3f position(point.x, point.y, point.z);
      extend({position, position, point.spacing});
    }
  };
  Box box(std::size_t block) const { return boxes_[0].box(block); }

  /// Lists the blocks in which there may be points that are nearer to one in a box than `reach` times the smaller spacing of the
  /// two, where those of the listed ones count as `least` at least. For any number of threads at a time, each with its scratch.
  void list_near(const Box& around, float reach, Scratch& scratch, float least = 0) const;
  /// Sets is_near of those listed that may have points so near to one point in the box.
  static void mark_near(const Point& point, float reach, Scratch& scratch, float least = 0);

  /// How much a point matters to another one whose normal is at an angle of such a cosine: 1 up to 90 degrees, 0 from 120 on, as
  /// neighbour_distances_on_side() has it.
  [[gnu::always_inline]] static float alike(float cosine) { return fast_min(fast_max(1 + 2 * cosine, 0.0F), 1.0F); }

 private:
  static constexpr std::size_t kFan = 8;    // boxes in a box
  static constexpr float kFarAway = 1e18F;  // its square is finite still

  /// In columns, filled up to whole fans with some that nothing is near to.
  struct Boxes {
    explicit Boxes(std::size_t boxes);

    Box box(std::size_t b) const { return {{low[0][b], low[1][b], low[2][b]}, {high[0][b], high[1][b], high[2][b]}, spacing[b]}; }
    void set(std::size_t b, const Box& box);

    std::size_t count;
    std::array<std::vector<float>, 3> low, high;  // by axis
    std::vector<float> spacing;
  };

  void add_near(std::size_t level, std::size_t fan, const Box& around, float reach, float least,
                std::vector<std::uint32_t>& near) const;

  const std::size_t size_;
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, spacing_;
  std::vector<Boxes> boxes_;  // by level, from the blocks' own up to a fan
};

}  // namespace curvecast
