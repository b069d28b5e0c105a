#include "core/measure/kd_order.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <tuple>

namespace curvecast {
namespace {

struct Item {
  Vec3d place;
  std::uint32_t index;
};

/// Sorts the items of runs [first, first + count).
void sort_runs(const Runs& runs, std::size_t first, std::size_t count, std::vector<Item>& items) {
  constexpr std::size_t kAlone = 4096;  // items that are not worth a second thread
  if (count < 2) return;
  const auto at = [&](std::size_t run) { return items.begin() + static_cast<std::ptrdiff_t>(runs.begin(run)); };
  const auto begin = at(first), end = at(first + count);
  Box3d box;
  for (auto item = begin; item != end; ++item) box.extend(item->place);
  int axis = 0;
  (box.max - box.min).maxCoeff(&axis);
  const std::size_t half = std::bit_ceil(count) / 2;
  std::nth_element(begin, at(first + half), end, [axis](const Item& a, const Item& b) {
    return std::tie(a.place[axis], a.index) < std::tie(b.place[axis], b.index);
  });
  const auto left = [&] { sort_runs(runs, first, half, items); };
  const auto right = [&] { sort_runs(runs, first + half, count - half, items); };
  if (static_cast<std::size_t>(end - begin) > kAlone) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

}  // namespace

std::vector<std::uint32_t> kd_order(std::span<const Vec3d> points, std::size_t size) {
  std::vector<Item> items;
  items.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) items.push_back({points[i], i});
  const Runs runs(points.size(), size);
  sort_runs(runs, 0, runs.count, items);
  std::vector<std::uint32_t> order;
  order.reserve(items.size());
  for (const Item& item : items) order.push_back(item.index);
  return order;
}

}  // namespace curvecast
