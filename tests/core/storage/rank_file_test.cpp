#include "core/storage/rank_file.h"

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <vector>

#include "core/pipeline/curve_surface.h"
#include "core/pipeline/pipeline.h"
#include "core/progressive/grow_ranks.h"
#include "core/storage/section_file.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast {
namespace {

using testing::bytes_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::write_file;
using Code = absl::StatusCode;

class RankFileTest : public ::testing::Test {
 protected:
  RankFileTest() {
    const std::string off = testing::to_off(testing::jittered(testing::icosphere(3), 0.02));
    absl::StatusOr<Preprocessed> made = preprocess({"ball.off", off}, {.points = 4000});
    EXPECT_TRUE(made.ok()) << made.status();
    made_ = *std::move(made);
    faces_ = made_.report.mesh.faces;
  }

  /// Ranks down to level 6, and deeper ones in one place.
  std::shared_ptr<const RankTree> ranks() const {
    const auto grower = RankGrower::make(leaf_surface(made_), {.level = 6});
    EXPECT_TRUE(grower.ok()) << grower.status();
    for (const ChunkId& id : {ChunkId{7, 3}, {8, 12}, {7, 9}}) {
      EXPECT_TRUE((*grower)->grow(std::vector<ChunkId>{id}, 1'000'000).ok());
    }
    EXPECT_EQ((*grower)->tree()->chunks().size(), 1u + 4 + 3);
    return (*grower)->tree();
  }
  static void expect_same(const RankChunk& a, const RankChunk& b) {
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.z, b.z);
    EXPECT_EQ(a.rank, b.rank);
    EXPECT_EQ(a.curve_position, b.curve_position);
    EXPECT_EQ(a.vertex, b.vertex);
    EXPECT_EQ(a.face, b.face);
    EXPECT_TRUE(std::ranges::equal(a.detail, b.detail));
    EXPECT_EQ(a.beside, b.beside);
    EXPECT_TRUE(std::ranges::equal(a.bounds.radius, b.bounds.radius));
    EXPECT_TRUE(std::ranges::equal(a.bounds.detail, b.bounds.detail));
    EXPECT_EQ(a.last_vertex, b.last_vertex);
  }

  Preprocessed made_;
  std::uint64_t faces_ = 0;
  TemporaryFolder folder_;
  const std::string path_ = folder_ / "ranks";
};

TEST_F(RankFileTest, BringsWholeLevelsBack) {
  const auto before = ranks();
  ASSERT_TRUE(save_ranks(path_, *before, {.whole_levels = 8}, "whose").ok());
  const auto after = load_ranks(path_, *made_.curve, faces_, "whose");
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_EQ(after->level, 6);
  ASSERT_EQ(after->tree->chunks().size(), 5u);
  for (std::size_t c = 0; c < 5; ++c) expect_same(*before->chunks()[c], *after->tree->chunks()[c]);
  ASSERT_TRUE(save_ranks(folder_ / "again", *after->tree, {.whole_levels = 8}, "whose").ok());
  EXPECT_EQ(bytes_of(path_), bytes_of(folder_ / "again"));
  ASSERT_TRUE(save_ranks(folder_ / "fewer", *before, {.whole_levels = 5}).ok());
  EXPECT_EQ(load_ranks(folder_ / "fewer", *made_.curve, faces_)->level, 5);
}

TEST_F(RankFileTest, BringsDeeperChunksBack) {
  const auto before = ranks();
  ASSERT_TRUE(save_ranks(path_, *before, {.whole_levels = 8, .most_deeper_points = 1'000'000}).ok());
  const auto after = load_ranks(path_, *made_.curve, faces_);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_EQ(after->level, 6);
  ASSERT_EQ(after->tree->chunks().size(), before->chunks().size());
  for (std::size_t c = 0; c < before->chunks().size(); ++c) expect_same(*before->chunks()[c], *after->tree->chunks()[c]);
}

TEST_F(RankFileTest, OfDeeperChunksThoseThatWereLookedAtLastComeFirst) {
  const auto before = ranks();
  const std::size_t chunk = kChunkStrata - kLayerStrata;  // points
  const auto saved = [&](std::size_t most) {
    EXPECT_TRUE(save_ranks(path_, *before, {.whole_levels = 6, .most_deeper_points = most}).ok());
    const auto after = load_ranks(path_, *made_.curve, faces_);
    EXPECT_TRUE(after.ok()) << after.status();
    std::vector<ChunkId> ids;
    for (const auto& c : after->tree->chunks().subspan(5)) ids.push_back(c->id);
    return ids;
  };
  // {7, 9} is the newest one.
  EXPECT_EQ(saved(chunk), (std::vector<ChunkId>{{7, 9}}));
  const std::uint64_t now = before->growth() + 1;
  before->chunks()[before->find({7, 3})]->used.set(now);
  EXPECT_EQ(saved(chunk), (std::vector<ChunkId>{{7, 3}}));
  before->chunks()[before->find({8, 12})]->used.set(now);
  EXPECT_EQ(saved(2 * chunk + 5), (std::vector<ChunkId>{{7, 3}, {8, 12}}));
  before->chunks()[before->find({8, 12})]->used.set(now + 1);
  EXPECT_EQ(saved(chunk), (std::vector<ChunkId>{{7, 3}})) << "what is continued comes first";
  EXPECT_EQ(saved(chunk - 1), std::vector<ChunkId>{});
}

TEST_F(RankFileTest, RefusesWhatIsDamagedOrOfAnother) {
  ASSERT_TRUE(save_ranks(path_, *ranks(), {.whole_levels = 8, .most_deeper_points = 1500}, "whose").ok());
  EXPECT_EQ(load_ranks(path_, *made_.curve, faces_, "nobody's").status().code(), Code::kDataLoss);
  EXPECT_EQ(load_ranks(path_, *made_.curve, 10, "whose").status().code(), Code::kDataLoss);
  SurfaceCurve shorter = *made_.curve;
  shorter.x.resize(shorter.x.size() / 2);
  EXPECT_THAT(load_ranks(path_, shorter, faces_, "whose").status().message(), HasSubstr("make no sense"));
  const std::string good = bytes_of(path_);
  for (std::size_t at = 0; at < good.size(); at += at < 2048 ? 41 : 1 + good.size() / 150) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    write_file(folder_ / "bad", bytes);
    EXPECT_FALSE(load_ranks(folder_ / "bad", *made_.curve, faces_, "whose").ok()) << at;
  }
  for (const std::size_t size : {std::size_t{0}, good.size() / 2, good.size() - 1}) {
    write_file(folder_ / "bad", good.substr(0, size));
    EXPECT_EQ(load_ranks(folder_ / "bad", *made_.curve, faces_, "whose").status().code(), Code::kDataLoss);
  }
  EXPECT_EQ(load_ranks(folder_ / "none", *made_.curve, faces_).status().code(), Code::kNotFound);
}

}  // namespace
}  // namespace curvecast
