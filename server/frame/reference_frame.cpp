#include "server/frame/reference_frame.h"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

namespace curvecast::server {
namespace {

int normal_bits_of(const PointSetRequest& request) { return request.draco ? request.draco->normal_bits : 0; }

}  // namespace

ReferenceFrame::ReferenceFrame(std::shared_ptr<const SurfaceCurve> curve, const RankSelection& selection,
                               const PointSetRequest& request, const ViewLattice& lattice)
    : curve_(std::move(curve)), lattice_(lattice), normal_bits_(normal_bits_of(request)), attributes_(request.attributes) {
  selection_.count = selection.count;
  selection_.scale = selection.scale;
  selection_.pixels = selection.pixels;
  const auto words_of = [&](const RankSelection::Part& part) {
    return std::span(selection.shown).subspan(part.first_bit / RankSelection::kWord, part.chunk->size() / RankSelection::kWord);
  };
  const auto is_shown = [&](const RankSelection::Part& part) {
    return std::ranges::any_of(words_of(part), [](std::uint64_t word) { return word != 0; });
  };
  std::size_t parts = 0, words = 0;
  for (const RankSelection::Part& part : selection.parts) {
    if (is_shown(part)) ++parts, words += words_of(part).size();
  }
  const auto digest = [this](const void* bytes, std::size_t size) { digest_ = XXH3_64bits_withSeed(bytes, size, digest_); };
  const std::uint64_t sent = std::uint64_t{attributes_.scalars} << 4 | std::uint64_t{attributes_.directions} << 3 |
                             std::uint64_t{attributes_.curvatures} << 2 | std::uint64_t{attributes_.rank} << 1 |
                             std::uint64_t{attributes_.surface};
  const std::uint64_t kind[] = {curve_->revision, static_cast<std::uint64_t>(lattice_.bits),
                                static_cast<std::uint64_t>(normal_bits_), sent};
  digest(kind, sizeof(kind));
  if (lattice_.centre) digest(lattice_.centre->data(), sizeof(Vec3d));
  selection_.parts.reserve(parts);
  selection_.shown.reserve(words);
  for (const RankSelection::Part& part : selection.parts) {
    if (!is_shown(part)) continue;
    selection_.parts.push_back({part.chunk, static_cast<std::uint32_t>(selection_.shown.size() * RankSelection::kWord)});
    const std::span<const std::uint64_t> shown = words_of(part);
    selection_.shown.insert(selection_.shown.end(), shown.begin(), shown.end());
    const ChunkId& id = part.chunk->id;
    const std::uint64_t name[] = {static_cast<std::uint64_t>(id.level), id.index};
    digest(name, sizeof(name));
    digest(shown.data(), shown.size_bytes());
  }
  keep_runs(selection.rungs);
  digest(discs_.data(), discs_.size() * sizeof(Run));
  digest_ = std::max<std::uint64_t>(digest_, 1);
}

void ReferenceFrame::keep_runs(std::span<const std::uint8_t> rungs) {
  constexpr std::size_t kLongest = std::numeric_limits<std::uint8_t>::max();
  std::vector<Run> runs;
  runs.reserve(rungs.size() / 4 + 1);
  std::size_t begin = 0;
  const auto end_run = [&](std::size_t end) {
    for (; end - begin > kLongest; begin += kLongest) runs.push_back({rungs[begin], kLongest});
    runs.push_back({rungs[begin], static_cast<std::uint8_t>(end - begin)});
    begin = end;
  };
  // Where a disc differs from the one before, found eight at a time.
  static_assert(std::endian::native == std::endian::little);
  std::size_t i = 1;
  for (; i + sizeof(std::uint64_t) <= rungs.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t these, before;
    std::memcpy(&these, &rungs[i], sizeof(these));
    std::memcpy(&before, &rungs[i - 1], sizeof(before));
    for (std::uint64_t differs = these ^ before; differs != 0;) {
      const int byte = std::countr_zero(differs) / 8;
      end_run(i + static_cast<std::size_t>(byte));
      differs &= ~(std::uint64_t{0xff} << 8 * byte);
    }
  }
  for (; i < rungs.size(); ++i) {
    if (rungs[i] != rungs[i - 1]) end_run(i);
  }
  if (!rungs.empty()) end_run(rungs.size());
  discs_.assign(runs.begin(), runs.end());  // what is kept has no room to spare
}

void ReferenceFrame::discs(std::vector<std::uint8_t>& rungs) const {
  // Most runs are short: sixteen are written whatever their length, and those after them written over.
  constexpr std::size_t kAtOnce = 16;
  rungs.resize(selection_.count + kAtOnce);
  std::uint8_t* next = rungs.data();
  for (const Run& run : discs_) {
    std::memset(next, run.rung, kAtOnce);
    if (run.count > kAtOnce) std::memset(next + kAtOnce, run.rung, run.count - kAtOnce);
    next += run.count;
  }
  rungs.resize(selection_.count);
}

bool ReferenceFrame::goes_with(const SurfaceCurve& curve, const PointSetRequest& request) const {
  return curve_.get() == &curve && normal_bits_ == normal_bits_of(request) && attributes_ == request.attributes;
}

std::size_t ReferenceFrame::byte_size() const {
  return sizeof(*this) + selection_.parts.capacity() * sizeof(RankSelection::Part) +
         selection_.shown.capacity() * sizeof(std::uint64_t) + discs_.capacity() * sizeof(Run);
}

}  // namespace curvecast::server
