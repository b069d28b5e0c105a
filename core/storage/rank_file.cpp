#include "core/storage/rank_file.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/progressive/progressive.h"
#include "core/storage/section_file.h"

namespace curvecast {
namespace {

constexpr FileKind kKind = {"RANKS", kRankFileVersion};

/// Calls visit(name, column, whether it may be empty) for the columns of a chunk.
template <typename Chunk, typename Visit>
void visit_columns(Chunk& chunk, const Visit& visit) {
  visit("x", chunk.x, false), visit("y", chunk.y, false), visit("z", chunk.z, false);
  visit("nx", chunk.nx, false), visit("ny", chunk.ny, false), visit("nz", chunk.nz, false);
  visit("rank", chunk.rank, false);
  visit("curve position", chunk.curve_position, false);
  visit("vertex", chunk.vertex, false);
  visit("face", chunk.face, false);
  visit("weight 1", chunk.weight_1, false), visit("weight 2", chunk.weight_2, false);
  visit("colour", chunk.colour, true);
}

/// What a chunk has besides its columns.
struct Runs {
  RunBounds bounds;
  std::array<std::uint32_t, kChunkRuns> first_vertex, last_vertex;
};

std::vector<ChunkId> chunks_down_to(int level) {
  std::vector<ChunkId> ids;
  for (int l = kChunkLevels; l <= level; ++l) {
    for (std::uint64_t i = 0; i < chunks_of_level(l); ++i) ids.push_back({l, i});
  }
  return ids;
}

/// Returns how many of a tree's first chunks are those of whole levels, and down to which level.
std::pair<std::size_t, int> whole_levels(std::span<const RankTree::Chunk> chunks, int deepest) {
  std::size_t count = 0;
  int level = kChunkLevels - 1;
  for (int next = kChunkLevels; next <= std::min(deepest, kMaxLevelAtOnce); ++next) {
    const std::size_t end = count + chunks_of_level(next);
    if (end > chunks.size() || chunks[end - 1]->id != ChunkId{next, chunks_of_level(next) - 1}) break;
    level = next;
    count = end;
  }
  return {count, level};
}

/// Returns, of a tree's chunks from `begin` on, those that were looked at last, up to about so many points, in their order. A
/// chunk comes with those that it continues.
std::vector<RankTree::Chunk> last_used(const RankTree& tree, std::size_t begin, std::size_t most_points) {
  const std::span<const RankTree::Chunk> chunks = tree.chunks();
  const std::size_t most = most_points / chunk_points(kChunkLevels + 1);
  std::vector<std::pair<std::uint64_t, std::size_t>> uses;  // of each: when it or what continues it was looked at last; its index
  for (std::size_t c = begin; c < chunks.size(); ++c) uses.emplace_back(chunks[c]->used.get(), c);
  for (std::size_t c = chunks.size(); c-- > begin;) {
    const std::size_t parent = tree.find({chunks[c]->id.level - 1, chunks[c]->id.index / 4});
    if (parent >= begin) uses[parent - begin].first = std::max(uses[parent - begin].first, uses[c - begin].first);
  }
  std::ranges::sort(uses,
                    [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  uses.resize(std::min(uses.size(), most));
  std::ranges::sort(uses, {}, [](const auto& use) { return use.second; });
  std::vector<RankTree::Chunk> out;
  for (const auto& [used, c] : uses) out.push_back(chunks[c]);
  return out;
}

/// Whether the numbers of a chunk are such as make_chunk() gives.
bool makes_sense(const RankChunk& chunk, const SurfaceCurve& curve, std::uint64_t faces) {
  const auto is_finite = [](float value) { return std::isfinite(value); };
  for (const AlignedVector<float>* column : {&chunk.x, &chunk.y, &chunk.z}) {
    if (!std::ranges::all_of(*column, is_finite)) return false;
  }
  const RunBounds& b = chunk.bounds;
  for (std::size_t r = 0; r < kChunkRuns; ++r) {
    for (const float value : {b.x[r], b.y[r], b.z[r], b.radius[r], b.nx[r], b.ny[r], b.nz[r], b.spread[r], b.detail[r]}) {
      if (!is_finite(value)) return false;
    }
    if (chunk.first_vertex[r] > chunk.last_vertex[r] || chunk.last_vertex[r] >= curve.size()) return false;
  }
  for (std::size_t i = 0; i < chunk.size(); ++i) {
    const std::uint64_t first = chunk.id.first_rank(i / kLayerStrata), position = chunk.curve_position[i];
    if (chunk.vertex[i] >= curve.size() || chunk.face[i] >= faces) return false;
    if (chunk.rank_of(i) < first || chunk.rank_of(i) >= first + chunk.id.layer_ranks()) return false;
    if (position < chunk.id.first_position() || position > chunk.id.last_position()) return false;
    if (chunk.id.stratum_in_layer(position) != i % kLayerStrata) return false;
  }
  return true;
}

}  // namespace

absl::Status save_ranks(const std::string& path, const RankTree& tree, const SaveRanksOptions& options, std::string_view note) {
  const std::span<const RankTree::Chunk> all = tree.chunks();  // by level
  const auto [whole, level] = whole_levels(all, options.whole_levels);
  std::vector<RankTree::Chunk> chunks(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(whole));
  std::vector<std::uint32_t> deeper_levels;
  std::vector<std::uint64_t> deeper_indices;
  for (RankTree::Chunk& chunk : last_used(tree, whole, options.most_deeper_points)) {
    deeper_levels.push_back(static_cast<std::uint32_t>(chunk->id.level));
    deeper_indices.push_back(chunk->id.index);
    chunks.push_back(std::move(chunk));
  }
  const auto whole_level = static_cast<std::uint32_t>(level);
  std::vector<Runs> runs;
  for (const RankTree::Chunk& chunk : chunks) runs.push_back({chunk->bounds, chunk->first_vertex, chunk->last_vertex});
  std::vector<Section> sections = {make_section("note", note), make_section("level", std::span(&whole_level, 1)),
                                   make_section("deeper levels", deeper_levels), make_section("deeper indices", deeper_indices),
                                   make_section("runs", runs)};
  const std::size_t first_column = sections.size();
  for (const RankTree::Chunk& chunk : chunks) {
    std::size_t i = first_column;
    visit_columns(*chunk, [&](const char* name, const auto& column, bool) {
      Section section = make_section(name, column);
      if (i == sections.size()) {
        sections.push_back(std::move(section));
      } else {
        sections[i].parts.push_back(section.parts.front());
      }
      ++i;
    });
  }
  return write_section_file(path, kKind, sections);
}

absl::StatusOr<RankFile> load_ranks(const std::string& path, const SurfaceCurve& curve, std::uint64_t faces,
                                    std::string_view note) {
  const absl::StatusOr<std::shared_ptr<const SectionFile>> file = SectionFile::open(path, kKind, FileAccess::kMap);
  if (!file.ok()) return file.status();
  const auto saved_note = (*file)->section<char>("note");
  const auto level = (*file)->section<std::uint32_t>("level");
  const auto deeper_levels = (*file)->section<std::uint32_t>("deeper levels");
  const auto deeper_indices = (*file)->section<std::uint64_t>("deeper indices");
  const auto runs = (*file)->section<Runs>("runs");
  for (const absl::Status& status :
       {saved_note.status(), level.status(), deeper_levels.status(), deeper_indices.status(), runs.status()}) {
    if (!status.ok()) return status;
  }
  if (std::string_view(saved_note->data(), saved_note->size()) != note) return (*file)->damaged("its ranks are of another curve");
  if (level->size() != 1 || level->front() < kChunkLevels || level->front() > kMaxLevelAtOnce) {
    return (*file)->damaged("its level is out of range");
  }
  const int whole = static_cast<int>(level->front());
  std::vector<ChunkId> ids = chunks_down_to(whole);
  if (deeper_levels->size() != deeper_indices->size() || runs->size() != ids.size() + deeper_levels->size()) {
    return (*file)->damaged("its chunks are not as many as it says");
  }
  for (std::size_t i = 0; i < deeper_levels->size(); ++i) {
    const auto deeper = static_cast<int>(std::min<std::uint32_t>((*deeper_levels)[i], kMaxRankLevel + 1));
    const ChunkId id{deeper, (*deeper_indices)[i]};
    if (deeper > kMaxRankLevel || id <= ids.back() || id.index >= chunks_of_level(deeper)) {
      return (*file)->damaged("its deeper chunks are out of range or order");
    }
    ids.push_back(id);
  }
  std::vector<std::shared_ptr<RankChunk>> chunks;
  for (const ChunkId& id : ids) {
    chunks.push_back(std::make_shared<RankChunk>());
    chunks.back()->id = id;
  }
  absl::Status status;
  std::size_t begin = 0;  // of a chunk in each column
  for (const std::shared_ptr<RankChunk>& chunk : chunks) {
    const std::size_t end = begin + chunk_points(chunk->id.level);
    visit_columns(*chunk, [&]<typename T, typename A>(const char* name, std::vector<T, A>& column, bool may_be_empty) {
      const absl::StatusOr<std::span<const T>> values = (*file)->section<T>(name);
      if (!values.ok()) return status.Update(values.status());
      if (may_be_empty && values->empty()) return;
      if (values->size() < end) return status.Update((*file)->damaged(absl::StrCat(name, " ends early")));
      column.assign(values->data() + begin, values->data() + end);
    });
    if (!status.ok()) return status;
    begin = end;
  }
  if (chunks.front()->colour.empty() != curve.colour.empty()) return (*file)->damaged("its colours are not the curve's");
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    RankChunk& chunk = *chunks[c];
    chunk.bounds = (*runs)[c].bounds;
    chunk.first_vertex = (*runs)[c].first_vertex;
    chunk.last_vertex = (*runs)[c].last_vertex;
    if (!makes_sense(chunk, curve, faces)) return (*file)->damaged("its ranks make no sense for the curve");
    fill_from_curve(curve, chunk);
  }
  if (absl::Status intact = (*file)->status(); !intact.ok()) return intact;
  return RankFile{std::make_shared<const RankTree>(std::vector<RankTree::Chunk>(chunks.begin(), chunks.end())), whole};
}

}  // namespace curvecast
