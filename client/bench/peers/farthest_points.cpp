#include "client/bench/peers/farthest_points.h"

#include <limits>
#include <queue>

#include "core/measure/neighbours.h"

namespace curvecast::cli::bench {
namespace {

/// A point's distance from those chosen, as it was once.
struct Candidate {
  float square;
  std::uint32_t index;
  bool operator<(const Candidate& other) const { return square != other.square ? square < other.square : index > other.index; }
};

}  // namespace

std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t n) {
  const NeighbourTree tree({points.begin(), points.end()});
  std::vector<float> squares(points.size(), std::numeric_limits<float>::max());
  std::priority_queue<Candidate> queue;
  if (n > 0) queue.push({squares[0], 0});
  std::vector<std::uint32_t> order;
  std::vector<Neighbour> near;
  while (order.size() < n) {
    const Candidate next = queue.top();
    queue.pop();
    if (next.square != squares[next.index]) continue;  // it has come nearer since
    order.push_back(next.index);
    squares[next.index] = -1;
    // Nobody who is farther from the new point than this is nearer to it than to those before.
    tree.within(points[next.index], next.square, near);
    for (const Neighbour& neighbour : near) {
      float& square = squares[neighbour.index];
      if (neighbour.square >= square) continue;
      square = neighbour.square;
      queue.push({square, neighbour.index});
    }
  }
  return order;
}

}  // namespace curvecast::cli::bench
