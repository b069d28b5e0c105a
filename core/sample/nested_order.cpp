#include "core/sample/nested_order.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "core/base/for_all.h"
#include "core/base/memory_claim.h"
#include "core/base/random.h"
#include "core/base/reversed_bits.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "order";
constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMostCandidates = 16;  // of a quarter; more make no difference
// Of a level's parts such a share chooses at once. In the order of reversed bits they are so many parts from one another.
constexpr std::uint64_t kTurnsApart = 64;
constexpr std::size_t kGrain = 64;
constexpr std::uint64_t kBytesPerPoint = 48;

/// The points taken so far, in boxes around parts of the curve.
class TakenPoints {
 public:
  explicit TakenPoints(std::span<const Vec3f> positions) : positions_(positions), taken_((positions.size() + kLeaf - 1) / kLeaf) {
    for (std::size_t nodes = taken_.size();; nodes = (nodes + kBranch - 1) / kBranch) {
      levels_.emplace_back(nodes);
      if (nodes == 1) break;
    }
  }

  void take(std::size_t i) {
    taken_[i / kLeaf] = static_cast<std::uint8_t>(taken_[i / kLeaf] | 1u << i % kLeaf);
    std::size_t node = i / kLeaf;
    for (std::vector<Eigen::AlignedBox3f>& level : levels_) {
      level[node].extend(positions_[i]);
      node /= kBranch;
    }
  }

  /// Returns the square of the distance from point i to the nearest that is taken; something else, `enough` or less, where that
  /// is as little.
  float nearest(std::size_t i, float enough) const {
    const Vec3f& p = positions_[i];
    float best = std::numeric_limits<float>::infinity();
    const auto look = [&](std::size_t leaf) {
      for (unsigned bits = taken_[leaf]; bits != 0; bits &= bits - 1) {
        const std::size_t other = leaf * kLeaf + static_cast<std::size_t>(std::countr_zero(bits));
        best = std::min(best, (positions_[other] - p).squaredNorm());
      }
    };
    // The nearest is likely to be near along the curve, too: then few boxes are left to look into.
    const std::size_t own = i / kLeaf, end = std::min(own + kNear + 1, taken_.size());
    for (std::size_t leaf = own > kNear ? own - kNear : 0; leaf < end; ++leaf) look(leaf);
    std::array<Open, kBranch * kMostLevels> open;
    std::size_t count = 0;
    open[count++] = {levels_.size() - 1, 0, 0};
    while (count > 0 && best > enough) {
      const Open at = open[--count];
      if (at.square >= best) continue;
      if (at.level == 0) {
        look(at.node);
      } else {
        count = open_children(at, p, best, open, count);
      }
    }
    return best;
  }

 private:
  static constexpr std::size_t kLeaf = 8, kBranch = 4;  // points and nodes of a node
  static constexpr std::size_t kNear = 4;               // leaves on both sides
  static constexpr std::size_t kMostLevels = 16;        // 8 4^16 points

  struct Open {
    std::size_t level, node;
    float square;  // of the distance to its box
  };

  /// Adds a node's children that are nearer than `best`, the nearest last. Returns how many nodes are open then.
  std::size_t open_children(const Open& at, const Vec3f& p, float best, std::span<Open> open, std::size_t count) const {
    const std::vector<Eigen::AlignedBox3f>& below = levels_[at.level - 1];
    const std::size_t begin = count, first = at.node * kBranch, end = std::min(first + kBranch, below.size());
    for (std::size_t child = first; child < end; ++child) {
      const float square = below[child].squaredExteriorDistance(p);
      if (!(square < best)) continue;
      std::size_t place = count++;
      for (; place > begin && open[place - 1].square < square; --place) open[place] = open[place - 1];
      open[place] = {at.level - 1, child, square};
    }
    return count;
  }

  const std::span<const Vec3f> positions_;
  std::vector<std::uint8_t> taken_;                       // a bit for each point of a leaf
  std::vector<std::vector<Eigen::AlignedBox3f>> levels_;  // around what is taken in each node; leaves first
};

class NestedOrder {
 public:
  NestedOrder(std::span<const Vec3f> positions, std::span<const float> radii)
      : n_(positions.size()), radii_(radii), taken_(positions), ranks_(positions.size()) {}

  absl::Status make(std::uint64_t seed, const ExecutionContext& context) {
    of_part_ = {static_cast<std::uint32_t>(random_unit(seed, 0) * static_cast<double>(n_))};
    take(of_part_[0]);
    for (int level = 0; next_ < n_; ++level) {
      if (absl::Status status = divide(level, context); !status.ok()) return status;
    }
    return absl::OkStatus();
  }
  std::vector<std::uint32_t> take_ranks() && { return std::move(ranks_); }

 private:
  struct Choice {
    std::uint32_t point = kNobody;
    std::uint64_t quarter = 0;
  };

  void take(std::uint32_t i) {
    taken_.take(i);
    ranks_[i] = next_++;
  }
  /// The first point of a quarter of the level that is being divided.
  std::uint32_t begin_of(std::uint64_t quarter) const { return static_cast<std::uint32_t>(quarter * n_ / quarters_); }
  bool is_open(std::uint64_t quarter) const {
    return of_quarter_[quarter] == kNobody && begin_of(quarter) < begin_of(quarter + 1);
  }

  /// From a point in each of the level's parts to one in each of their quarters.
  absl::Status divide(int level, const ExecutionContext& context) {
    const std::uint64_t parts = std::uint64_t{1} << 2 * level;
    quarters_ = 4 * parts;
    of_quarter_.assign(quarters_, kNobody);
    own_.assign(parts, 0);
    for (std::uint64_t part = 0; part < parts; ++part) {
      if (of_part_[part] == kNobody) continue;
      while (begin_of(4 * part + own_[part] + 1) <= of_part_[part]) ++own_[part];
      of_quarter_[4 * part + own_[part]] = of_part_[part];
    }
    const std::uint64_t at_once = std::max<std::uint64_t>(1, parts / kTurnsApart);
    std::vector<Choice> chosen(at_once);
    for (const std::uint64_t turn : {2, 1, 3}) {  // the opposite quarter first
      for (std::uint64_t begin = 0; begin < parts; begin += at_once) {
        if (absl::Status status = context.check(); !status.ok()) return status;
        for_blocks(context, at_once, kGrain, [&](std::size_t first, std::size_t last) {
          for (std::size_t k = first; k < last; ++k) chosen[k] = choose(reversed_bits(begin + k, 2 * level), turn);
        });
        for (const Choice& choice : chosen) {
          if (choice.point == kNobody) continue;
          take(choice.point);
          of_quarter_[choice.quarter] = choice.point;
        }
      }
      context.progress(kStage, static_cast<double>(next_) / static_cast<double>(n_));
    }
    of_part_.swap(of_quarter_);
    return absl::OkStatus();
  }

  /// The next point of a part, which has none to give where all are taken.
  Choice choose(std::uint64_t part, std::uint64_t turn) const {
    Choice choice;
    float farthest = -1;
    if (n_ < 2 * quarters_) {
      // Hardly a quarter has two points, and some have none: a point of any of them, or prefixes would be dense where quarters
      // are.
      for (std::uint64_t quarter = 4 * part; quarter < 4 * part + 4; ++quarter) {
        if (is_open(quarter)) look_for_farthest(quarter, choice, farthest);
      }
    } else if (const std::uint64_t quarter = 4 * part + (own_[part] + turn) % 4; is_open(quarter)) {
      look_for_farthest(quarter, choice, farthest);
    }
    return choice;
  }

  void look_for_farthest(std::uint64_t quarter, Choice& choice, float& farthest) const {
    const std::uint32_t begin = begin_of(quarter), size = begin_of(quarter + 1) - begin;
    const std::size_t count = std::min<std::size_t>(size, kMostCandidates);
    for (std::size_t c = 0; c < count; ++c) {
      const auto i = static_cast<std::uint32_t>(begin + (2 * c + 1) * size / (2 * count));
      const float square = radii_[i] * radii_[i];
      const float distance = taken_.nearest(i, farthest * square) / square;
      if (distance > farthest) farthest = distance, choice = {i, quarter};
    }
  }

  const std::uint64_t n_;
  const std::span<const float> radii_;
  TakenPoints taken_;
  std::vector<std::uint32_t> ranks_;
  std::uint32_t next_ = 0;
  std::uint64_t quarters_ = 0;
  std::vector<std::uint32_t> of_part_, of_quarter_;  // the point taken in each, or kNobody
  std::vector<std::uint8_t> own_;                    // of each part: which quarter has its point
};

}  // namespace

absl::StatusOr<std::vector<std::uint32_t>> nested_order(std::span<const Vec3f> positions, std::span<const float> radii,
                                                        std::uint64_t seed, const ExecutionContext& context) {
  if (positions.empty()) return std::vector<std::uint32_t>();
  MemoryClaim claim(context);
  const std::uint64_t bytes = kBytesPerPoint * positions.size();
  const std::string what =
      absl::StrFormat("ordering %d points takes %s of memory", positions.size(), describe_bytes(static_cast<double>(bytes)));
  if (absl::Status status = claim.set(bytes, what); !status.ok()) return status;
  context.progress(kStage, 0);
  NestedOrder order(positions, radii);
  if (absl::Status status = order.make(seed, context); !status.ok()) return status;
  return std::move(order).take_ranks();
}

}  // namespace curvecast
