#include "core/measure/neighbours.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <nanoflann.hpp>
#include <tuple>
#include <utility>

namespace curvecast {
namespace {

constexpr std::size_t kLeafSize = 16;

/// Points as nanoflann wants them.
struct Cloud {
  std::vector<Vec3f> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i].data()[axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

struct Cancelled {};

/// The same points for whoever builds the tree. That takes seconds where there are millions, and nanoflann does not ask whether
/// it shall go on: so each point that it looks at may end it.
struct BuiltCloud : Cloud {
  const std::atomic<bool>* cancel = nullptr;

  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) throw Cancelled();
    return Cloud::kdtree_get_pt(i, axis);
  }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, BuiltCloud, 3, std::uint32_t>;

/// The limit to give to nanoflann, which wants less than it: beyond `square` by more than its rounded distances to boxes are off,
/// so that no point at that very distance is passed over.
float just_beyond(float square) { return square * 1.00001f + std::numeric_limits<float>::min(); }

/// Keeps the nearest of what nanoflann offers, sorted.
class Nearest {
 public:
  /// `found` holds nobody. The point `but` is not wanted.
  Nearest(std::span<Neighbour> found, std::uint32_t but) : found_(found), but_(but) {}

  bool full() const { return true; }
  // NOLINTBEGIN(readability-identifier-naming): nanoflann names those that it calls
  float worstDist() const { return just_beyond(found_.back().square); }
  bool addPoint(float square, std::uint32_t index) {
    const auto is_before = [](const Neighbour& a, const Neighbour& b) {
      return std::tie(a.square, a.index) < std::tie(b.square, b.index);
    };
    const Neighbour offer{index, square};
    if (index == but_ || !is_before(offer, found_.back())) return true;
    std::size_t i = found_.size() - 1;
    for (; i > 0 && is_before(offer, found_[i - 1]); --i) found_[i] = found_[i - 1];
    found_[i] = offer;
    return true;
  }
  // NOLINTEND(readability-identifier-naming)

 private:
  std::span<Neighbour> found_;
  std::uint32_t but_;
};

/// Keeps all that nanoflann offers within a distance, until there are more than `most`.
class Within {
 public:
  Within(float square, std::size_t most, std::vector<Neighbour>& found) : square_(square), most_(most), found_(found) {}

  bool full() const { return true; }
  // NOLINTBEGIN(readability-identifier-naming)
  float worstDist() const { return just_beyond(square_); }
  bool addPoint(float square, std::uint32_t index) {
    if (square <= square_) found_.push_back({index, square});
    return found_.size() <= most_;
  }
  // NOLINTEND(readability-identifier-naming)

 private:
  float square_;
  std::size_t most_;
  std::vector<Neighbour>& found_;
};

}  // namespace

struct NeighbourTree::Tree {
  Tree(std::vector<Vec3f> points, const std::atomic<bool>* cancel)
      : cloud{{std::move(points)}, cancel},
        index(3, cloud, {kLeafSize, nanoflann::KDTreeSingleIndexAdaptorFlags::SkipInitialBuildIndex}) {
    index.buildIndex();
    cloud.cancel = nullptr;
  }

  void nearest(const Vec3f& query, std::span<Neighbour> found, std::uint32_t but = Neighbour::kNobody) const {
    std::fill(found.begin(), found.end(), Neighbour{});
    if (found.empty() || cloud.points.empty()) return;
    Nearest nearest(found, but);
    index.findNeighbors(nearest, query.data(), {});
  }

  BuiltCloud cloud;
  Index index;
};

NeighbourTree::NeighbourTree(std::vector<Vec3f> points, const std::atomic<bool>* cancel)
    : tree_(std::make_shared<const Tree>(std::move(points), cancel)) {}

absl::StatusOr<NeighbourTree> NeighbourTree::build(std::vector<Vec3f> points, const ExecutionContext& context) {
  try {
    return NeighbourTree(std::move(points), context.cancel);
  } catch (const Cancelled&) {
    return context.check();
  }
}

std::span<const Vec3f> NeighbourTree::points() const { return tree_->cloud.points; }

std::size_t NeighbourTree::nearest(const Vec3f& query, std::span<Neighbour> found) const {
  tree_->nearest(query, found);
  return std::min(found.size(), points().size());
}

std::size_t NeighbourTree::nearest_others(std::uint32_t i, std::span<Neighbour> found) const {
  tree_->nearest(points()[i], found, i);
  return std::min(found.size(), points().size() - 1);
}

void NeighbourTree::within(const Vec3f& query, float square, std::vector<Neighbour>& found, std::size_t most) const {
  found.clear();
  if (points().empty()) return;
  Within all(square, most, found);
  tree_->index.findNeighbors(all, query.data(), {});
  if (found.size() > most) return;
  std::sort(found.begin(), found.end(), [](const Neighbour& a, const Neighbour& b) { return a.index < b.index; });
}

void NeighbourTree::all_nearest(std::size_t k, std::span<Neighbour> found) const {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points().size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      nearest_others(static_cast<std::uint32_t>(i), found.subspan(i * k, k));
    }
  });
}

}  // namespace curvecast
