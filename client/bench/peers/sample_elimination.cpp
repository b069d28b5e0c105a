#include "client/bench/peers/sample_elimination.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "core/measure/spacing.h"

namespace curvecast::cli::bench {
namespace {

constexpr double kBeta = 0.65, kGamma = 1.5;  // of the limit of weights

/// In units of 2^-40: whole numbers, so that what was added comes off again to the bit.
using Weight = std::int64_t;
constexpr double kWeightUnit = 0x1p40;
constexpr Weight kGone = -1;

/// How much two points at a distance weigh on each other. Distances in the cloud's own units.
class PairWeight {
 public:
  PairWeight(double area, std::size_t n, const PointCloud& candidates) : reach_(2 * packing_radius(area, n) / candidates.unit) {
    const double share = static_cast<double>(n) / static_cast<double>(candidates.size());
    least_ = kBeta * (1 - std::pow(share, kGamma)) * reach_;
  }

  float square() const { return static_cast<float>(reach_ * reach_); }
  Weight operator()(const Neighbour& other) const {
    const double distance = std::clamp(std::sqrt(double{other.square}), least_, reach_);
    const double near = 1 - distance / reach_;
    const double second = near * near, fourth = second * second;
    return std::llround(fourth * fourth * kWeightUnit);  // alpha = 8
  }

 private:
  double reach_, least_;
};

/// A point and its weight as it was once, which is at least what it is now.
struct Candidate {
  Weight weight;
  std::uint32_t index;
  bool operator<(const Candidate& other) const { return weight != other.weight ? weight < other.weight : index > other.index; }
};

}  // namespace

absl::StatusOr<std::vector<std::uint32_t>> eliminate_samples(const PointCloud& candidates, double area, std::size_t n,
                                                             const ExecutionContext& context) {
  const NeighbourTree& tree = candidates.tree;
  const PairWeight weight_of(area, n, candidates);
  std::vector<Weight> weights(candidates.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, weights.size(), 1024), [&](const auto& range) {
    if (context.cancelled()) return;
    std::vector<Neighbour> near;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      tree.within(tree.points()[i], weight_of.square(), near);
      for (const Neighbour& other : near) weights[i] += other.index == i ? 0 : weight_of(other);
    }
  });
  std::vector<Candidate> all;
  for (std::uint32_t i = 0; i < weights.size(); ++i) all.push_back({weights[i], i});
  std::priority_queue<Candidate> queue({}, std::move(all));
  std::vector<Neighbour> near;
  for (std::size_t left = candidates.size(); left > n;) {
    if (left % 1024 == 0 && context.cancelled()) break;
    const Candidate next = queue.top();
    queue.pop();
    if (next.weight != weights[next.index]) {  // neighbours have gone since
      queue.push({weights[next.index], next.index});
      continue;
    }
    weights[next.index] = kGone;
    --left;
    tree.within(tree.points()[next.index], weight_of.square(), near);
    for (const Neighbour& other : near) {
      Weight& weight = weights[other.index];
      if (weight != kGone) weight -= weight_of(other);
    }
  }
  if (absl::Status status = context.check(); !status.ok()) return status;
  std::vector<std::uint32_t> rest;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    if (weights[i] != kGone) rest.push_back(i);
  }
  return rest;
}

}  // namespace curvecast::cli::bench
