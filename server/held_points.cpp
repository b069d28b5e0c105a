#include "server/held_points.h"

#include <algorithm>

namespace curvecast::server {

std::shared_ptr<const HeldPoints> hold(const std::shared_ptr<const SurfaceCurve>& curve, const RankSelection& selection,
                                       const Sample& sample) {
  auto held = std::make_shared<HeldPoints>(HeldPoints{curve, {}, sample.draco, sample.attributes});
  RankSelection& out = held->selection;
  out.tree = selection.tree;
  out.count = selection.count;
  out.rungs = selection.rungs;
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
  out.parts.reserve(parts);
  out.shown.reserve(words);
  for (const RankSelection::Part& part : selection.parts) {
    if (!is_shown(part)) continue;
    out.parts.push_back({part.chunk, static_cast<std::uint32_t>(out.shown.size() * RankSelection::kWord)});
    const std::span<const std::uint64_t> shown = words_of(part);
    out.shown.insert(out.shown.end(), shown.begin(), shown.end());
  }
  return held;
}

bool goes_with(const HeldPoints& held, const SurfaceCurve& curve, const Sample& sample) {
  const auto bits = [](const std::optional<DracoOptions>& draco) {
    return draco ? std::pair(draco->position_bits, draco->normal_bits) : std::pair(0, 0);
  };
  return held.curve.get() == &curve && bits(held.draco) == bits(sample.draco) && held.attributes == sample.attributes;
}

}  // namespace curvecast::server
