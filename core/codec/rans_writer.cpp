#include "core/codec/rans_writer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>

namespace curvecast {
namespace {

/// Takes from the most probable ones first, each by the same part if that is enough, until all add up to `precision`.
void take_excess(std::uint32_t precision, std::uint32_t total, std::span<std::uint32_t> probabilities) {
  std::vector<std::uint64_t> order;  // probability, symbol; those of 1 have nothing to give
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    if (probabilities[i] > 1) order.push_back(std::uint64_t{probabilities[i]} << 32 | i);
  }
  std::sort(order.begin(), order.end(), std::greater<>());
  if (order.size() == probabilities.size()) order.pop_back();  // the least one never gives, as in Draco
  while (total > precision) {
    const double part = static_cast<double>(precision) / static_cast<double>(total);
    for (const std::uint64_t key : order) {
      std::uint32_t& probability = probabilities[key & 0xffffffff];
      if (probability <= 1 || total == precision) break;
      const auto rest = static_cast<std::uint32_t>(part * static_cast<double>(probability));
      const std::uint32_t taken = std::min({std::max(probability - rest, 1u), probability - 1, total - precision});
      probability -= taken;
      total -= taken;
    }
  }
}

std::vector<std::uint32_t> probabilities_of(std::span<const std::uint32_t> counts, std::uint32_t precision) {
  const auto all = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
  std::vector<std::uint32_t> probabilities(counts.size());
  std::uint32_t total = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const auto rounded = static_cast<std::uint32_t>(static_cast<double>(counts[i]) / all * precision + 0.5);
    probabilities[i] = std::max(rounded, 1u);
    total += probabilities[i];
  }
  if (total < precision) {
    // The last of the most probable ones, as in Draco.
    const auto most = std::max_element(probabilities.rbegin(), probabilities.rend());
    *most += precision - total;
  } else if (total > precision) {
    take_excess(precision, total, probabilities);
  }
  return probabilities;
}

// The state lies between 4 and 1024 times the precision.
constexpr std::uint64_t kLeastState = 4, kStateRange = 256;

__extension__ using Wide = unsigned __int128;

}  // namespace

RansTable::RansTable(std::span<const std::uint32_t> counts, int precision_bits)
    : precision_bits_(precision_bits), probabilities_(probabilities_of(counts, 1u << precision_bits)), steps_(counts.size()) {
  const std::uint64_t precision = std::uint64_t{1} << precision_bits;
  std::uint32_t start = 0;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const std::uint32_t probability = probabilities_[i];
    if (probability == 0) continue;
    std::uint64_t divisor = probability;
    std::uint32_t bits = 0;
    for (; kLeastState * kStateRange * divisor <= kLeastState * precision; divisor *= kStateRange) bits += 8;
    steps_[i] = {.inverse = ~std::uint64_t{0} / divisor + 1,
                 .last = static_cast<std::uint32_t>(kLeastState * kStateRange * divisor - 1),
                 .start = start,
                 .complement = static_cast<std::uint32_t>(precision) - probability,
                 .bits = bits};
    start += probability;
  }
}

void RansTable::write(ByteWriter& bytes) const {
  // The lowest two bits: how many more bytes a probability has, or 3 for a row of symbols that do not occur.
  constexpr std::uint32_t kMostSkipped = 63;
  bytes.put_varint(probabilities_.size());
  for (std::size_t i = 0; i < probabilities_.size(); ++i) {
    const std::uint32_t probability = probabilities_[i];
    if (probability == 0) {
      std::uint32_t more = 0;
      while (more < kMostSkipped && probabilities_[i + more + 1] == 0) ++more;
      bytes.put_byte(static_cast<int>(more << 2 | 3));
      i += more;
      continue;
    }
    const int more = probability < 1 << 6 ? 0 : probability < 1 << 14 ? 1 : 2;
    bytes.put_byte(static_cast<int>(probability << 2 | static_cast<std::uint32_t>(more)));
    for (int k = 1; k <= more; ++k) bytes.put_byte(static_cast<int>(probability >> (8 * k - 2)));
  }
}

/// One run on its way.
class RansCoder {
 public:
  explicit RansCoder(RansRun& run)
      : steps_(run.table->steps_.data()),
        base_(static_cast<std::uint32_t>(kLeastState) << run.table->precision_bits_),
        state_(base_),
        first_(run.symbols.data()),
        next_(first_ + run.symbols.size()) {
    // A symbol gives off three bytes at most.
    run.buffer = std::make_unique_for_overwrite<std::uint8_t[]>(3 * run.symbols.size() + sizeof state_);
    out_ = run.buffer.get();
  }

  std::size_t left() const { return static_cast<std::size_t>(next_ - first_); }

  [[gnu::always_inline]] void step() {
    const RansTable::Step& step = steps_[*--next_];
    // 8 above the last, where the difference has its highest bit set.
    const std::uint32_t more = (step.last - state_) >> 28 & 8;
    // floor(floor(x / d) / 256) = floor(x / (256 d)), without another multiplication.
    const auto quotient = static_cast<std::uint32_t>(static_cast<Wide>(step.inverse) * state_ >> 64) >> more;
    const std::uint32_t shift = step.bits + more;
    std::memcpy(out_, &state_, sizeof state_);
    out_ += shift / 8;
    state_ = (state_ >> shift) + step.start + quotient * step.complement;
  }

  /// The last state, with its own length in the highest two bits.
  void finish(RansRun& run) {
    const std::uint32_t rest = state_ - base_;
    const std::uint32_t more = rest < 1 << 6 ? 0 : rest < 1 << 14 ? 1 : rest < 1 << 22 ? 2 : 3;
    const std::uint32_t marked = rest | more << (8 * more + 6);
    std::memcpy(out_, &marked, sizeof marked);
    run.size = static_cast<std::size_t>(out_ - run.buffer.get()) + more + 1;
  }

 private:
  const RansTable::Step* steps_;
  std::uint32_t base_, state_;
  const std::uint32_t *first_, *next_;
  std::uint8_t* out_;
};

void code_runs(std::span<RansRun* const> runs) {
  if (runs.empty()) return;
  std::size_t next = 0;
  RansRun* run = runs[next++];
  RansCoder coder(*run);
  for (; next < runs.size(); ++next) {
    RansRun* other_run = runs[next];
    RansCoder other(*other_run);
    for (std::size_t n = std::min(coder.left(), other.left()); n > 0; --n) {
      coder.step();
      other.step();
    }
    if (coder.left() == 0) {  // the longer one goes on beside the next run
      std::swap(coder, other);
      std::swap(run, other_run);
    }
    other.finish(*other_run);
  }
  while (coder.left() > 0) coder.step();
  coder.finish(*run);
}

}  // namespace curvecast
