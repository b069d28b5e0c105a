#include "server/held_points.h"

#include <xxhash.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace curvecast::server {
namespace {

std::pair<int, int> bits_of(const std::optional<DracoOptions>& draco) {
  return draco ? std::pair(draco->position_bits, draco->normal_bits) : std::pair(0, 0);
}

}  // namespace

HeldPoints::HeldPoints(std::shared_ptr<const SurfaceCurve> curve, const RankSelection& selection, const Sample& sample)
    : curve_(std::move(curve)), draco_(sample.draco), attributes_(sample.attributes) {
  selection_.tree = selection.tree;
  selection_.count = selection.count;
  const auto words_of = [&](const RankSelection::Part& part) {
    return std::span(selection.shown)
        .subspan(part.first_bit / RankSelection::kWord, selection.tree->chunks()[part.chunk]->size() / RankSelection::kWord);
  };
  const auto is_shown = [&](const RankSelection::Part& part) {
    return std::ranges::any_of(words_of(part), [](std::uint64_t word) { return word != 0; });
  };
  std::size_t parts = 0, words = 0;
  for (const RankSelection::Part& part : selection.parts) {
    if (is_shown(part)) ++parts, words += words_of(part).size();
  }
  const auto digest = [this](const void* bytes, std::size_t size) { digest_ = XXH3_64bits_withSeed(bytes, size, digest_); };
  const auto [position_bits, normal_bits] = bits_of(draco_);
  const std::uint64_t kind[] = {
      curve_->revision, static_cast<std::uint64_t>(position_bits), static_cast<std::uint64_t>(normal_bits),
      std::uint64_t{attributes_.curvatures} << 2 | std::uint64_t{attributes_.rank} << 1 | std::uint64_t{attributes_.surface}};
  digest(kind, sizeof(kind));
  selection_.parts.reserve(parts);
  selection_.shown.reserve(words);
  for (const RankSelection::Part& part : selection.parts) {
    if (!is_shown(part)) continue;
    selection_.parts.push_back({part.chunk, static_cast<std::uint32_t>(selection_.shown.size() * RankSelection::kWord)});
    const std::span<const std::uint64_t> shown = words_of(part);
    selection_.shown.insert(selection_.shown.end(), shown.begin(), shown.end());
    const ChunkId& id = selection.tree->chunks()[part.chunk]->id;
    const std::uint64_t name[] = {static_cast<std::uint64_t>(id.level), id.index};
    digest(name, sizeof(name));
    digest(shown.data(), shown.size_bytes());
  }
  keep_runs(selection.rungs);
  digest(discs_.data(), discs_.size() * sizeof(Run));
  digest_ = std::max<std::uint64_t>(digest_, 1);
}

void HeldPoints::keep_runs(std::span<const std::uint8_t> rungs) {
  constexpr std::size_t kLongest = std::numeric_limits<std::uint8_t>::max();
  std::size_t changes = 0;
  for (std::size_t i = 1; i < rungs.size(); ++i) changes += rungs[i] != rungs[i - 1] ? 1 : 0;
  std::vector<Run> runs;
  runs.reserve(changes + rungs.size() / kLongest + 1);
  for (std::size_t i = 0, end = 0; i < rungs.size(); i = end) {
    const std::size_t limit = std::min(rungs.size(), i + kLongest);
    while (end < limit && rungs[end] == rungs[i]) ++end;
    runs.push_back({rungs[i], static_cast<std::uint8_t>(end - i)});
  }
  discs_.assign(runs.begin(), runs.end());  // what is kept has no room to spare
}

void HeldPoints::discs(std::vector<std::uint8_t>& rungs) const {
  rungs.resize(selection_.count);
  auto next = rungs.begin();
  for (const Run& run : discs_) next = std::fill_n(next, run.count, run.rung);
}

bool HeldPoints::goes_with(const SurfaceCurve& curve, const Sample& sample) const {
  return curve_.get() == &curve && bits_of(draco_) == bits_of(sample.draco) && attributes_ == sample.attributes;
}

std::size_t HeldPoints::byte_size() const {
  return sizeof(*this) + selection_.parts.capacity() * sizeof(RankSelection::Part) +
         selection_.shown.capacity() * sizeof(std::uint64_t) + discs_.capacity() * sizeof(Run);
}

}  // namespace curvecast::server
