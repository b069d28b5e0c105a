#include "proto/formats/tileset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "tests/proto/formats/parsed_glb.h"
#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

using nlohmann::json;
using Files = std::map<std::string, std::string>;
using Place = std::array<double, 3>;

constexpr GlbOptions kFloats{.quantise = false};

Files tiles_of(const PointColumns& columns, const TilesetOptions& options) {
  Files files;
  const absl::Status status = make_tileset(columns, options, [&](TileFile file) {
    EXPECT_TRUE(files.emplace(file.name, std::move(file.bytes)).second) << file.name << " comes twice";
    return absl::OkStatus();
  });
  EXPECT_TRUE(status.ok()) << status;
  return files;
}

/// Calls visit(tile, its level among tiles with content, places of its own points) for all tiles, as a viewer walks over them.
void walk(const Files& files, const json& tile, int level,
          const std::function<void(const json& tile, int level, const std::vector<Place>& own)>& visit) {
  std::vector<Place> own;
  const bool has_content = tile.contains("content");
  if (has_content) {
    const std::string uri = tile["content"]["uri"];
    ASSERT_TRUE(files.contains(uri)) << uri;
    if (uri.ends_with(".json")) {
      const json below = json::parse(files.at(uri));
      EXPECT_EQ(below["asset"]["version"], "1.1");
      EXPECT_FALSE(tile.contains("children")) << "3D Tiles allows none beside another set";
      return walk(files, below["root"], level, visit);
    }
    const ParsedGlb glb(files.at(uri));
    // Viewers turn the second axis of glTF upwards.
    for (const std::vector<double>& position : glb.numbers("POSITION")) {
      const Place p = glb.in_scene(position);
      own.push_back({p[0], -p[2], p[1]});
    }
  }
  visit(tile, level, own);
  if (!tile.contains("children")) return;
  for (const json& child : tile["children"]) walk(files, child, has_content ? level + 1 : level, visit);
}

bool holds(const json& volume, const Place& p) {
  const std::vector<double> box = volume["box"];
  const double half[3] = {box[3], box[7], box[11]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(p[axis] - box[axis]) > half[axis] + 1e-9) return false;
  }
  return true;
}

double distance(const Place& a, const Place& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

class TilesetTest : public ::testing::TestWithParam<std::array<double, 3>> {
 protected:
  PointColumns columns() const {
    PointColumns out = sphere_.columns();
    out.origin = GetParam();
    return out;
  }
  Place in_set(std::size_t point) const {
    const PointColumns all = columns();
    return {all.absolute(point, 0), -all.absolute(point, 2), all.absolute(point, 1)};
  }

  const SpherePoints sphere_{6000};
};

TEST_P(TilesetTest, HasEachPointOnceAndInLevelsThatAreCoarserSets) {
  const Files files = tiles_of(columns(), {.root_points = 100, .content = kFloats});
  std::map<int, std::set<Place>> of_level;
  std::size_t count = 0;
  walk(files, json::parse(files.at("tileset.json"))["root"], 0, [&](const json&, int level, const std::vector<Place>& own) {
    of_level[level].insert(own.begin(), own.end());
    count += own.size();
  });
  EXPECT_EQ(count, 6000U);
  ASSERT_EQ(of_level.size(), 4U);
  std::set<Place> shown;
  std::size_t prefix = 100;
  for (const auto& [level, own] : of_level) {
    shown.insert(own.begin(), own.end());
    std::set<Place> wanted;
    for (std::size_t rank = 0; rank < std::min<std::size_t>(prefix, 6000); ++rank) wanted.insert(in_set(sphere_.with_rank(rank)));
    EXPECT_EQ(shown, wanted) << "level " << level;
    prefix *= 4;
  }
}

TEST_P(TilesetTest, HasBoxesAndErrorsThatAreTrueAndNoLargerThanThat) {
  for (const GlbOptions& content : {kFloats, GlbOptions{.quantise = true, .compress = true}}) {
    const Files files = tiles_of(columns(), {.root_points = 100, .content = content});
    const json root = json::parse(files.at("tileset.json"))["root"];
    std::vector<std::vector<Place>> levels(4);
    std::map<std::string, std::vector<Place>> below;  // by the box, which no two tiles share
    walk(files, root, 0, [&](const json&, int level, const std::vector<Place>& own) {
      levels[static_cast<std::size_t>(level)].insert(levels[static_cast<std::size_t>(level)].end(), own.begin(), own.end());
    });
    std::function<std::vector<Place>(const json&, int, double)> check = [&](const json& tile, int level, double above) {
      std::vector<Place> all, under;
      walk(files, tile, level, [&](const json&, int at, const std::vector<Place>& own) {
        all.insert(all.end(), own.begin(), own.end());
        if (at > level) under.insert(under.end(), own.begin(), own.end());
      });
      Place low = all.front(), high = all.front();
      for (const Place& p : all) {
        EXPECT_TRUE(holds(tile["boundingVolume"], p));
        for (std::size_t axis = 0; axis < 3; ++axis)
          low[axis] = std::min(low[axis], p[axis]), high[axis] = std::max(high[axis], p[axis]);
      }
      const std::vector<double> box = tile["boundingVolume"]["box"];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(2 * box[3 + 4 * axis], high[axis] - low[axis], content.quantise ? 1e-4 : 1e-6);
      }
      double error = 0;
      for (const Place& p : under) {
        double nearest = 1e9;
        for (std::size_t l = 0; l <= static_cast<std::size_t>(level); ++l) {
          for (const Place& q : levels[l]) nearest = std::min(nearest, distance(p, q));
        }
        error = std::max(error, nearest);
      }
      EXPECT_NEAR(tile["geometricError"].get<double>(), error, content.quantise ? 1e-4 : 1e-6);
      EXPECT_LE(tile["geometricError"].get<double>(), above);
      return all;
    };
    check(root, 0, 1e9);
    for (const json& child : root["children"]) check(child, 1, root["geometricError"]);
  }
}

INSTANTIATE_TEST_SUITE_P(Origins, TilesetTest,
                         ::testing::Values(std::array<double, 3>{}, std::array<double, 3>{500'000, -4'600'000, 12}));

TEST(Tileset, DividesItsDescriptionIntoFiles) {
  const SpherePoints sphere(6000);
  const Files files = tiles_of(sphere.columns(), {.root_points = 20, .json_levels = 2});
  EXPECT_LT(files.at("tileset.json").size(), 4000U);
  EXPECT_TRUE(files.contains("1-3.json"));
  EXPECT_TRUE(files.contains("3-63.json"));
  EXPECT_FALSE(files.contains("2-0.json"));
}

TEST(Tileset, MayBeOneTile) {
  const SpherePoints sphere(50);
  const Files files = tiles_of(sphere.columns(), {});
  EXPECT_EQ(files.size(), 2U);
  const json root = json::parse(files.at("tileset.json"))["root"];
  EXPECT_EQ(root["geometricError"], 0);
  EXPECT_FALSE(root.contains("children"));
  EXPECT_EQ(root["refine"], "ADD");
}

TEST(Tileset, TurnsMeshesWhoseThirdAxisPointsUpwards) {
  const SpherePoints sphere(50);
  const Files files = tiles_of(sphere.columns(), {.z_up = true});
  const std::vector<double> m = json::parse(files.at("tileset.json"))["root"]["transform"];
  // Columns: (x, -z, y) becomes (x, y, z).
  const Place p = {1, 2, 3}, turned = {p[0], -p[2], p[1]};
  for (std::size_t row = 0; row < 3; ++row) {
    EXPECT_EQ(m[row] * turned[0] + m[4 + row] * turned[1] + m[8 + row] * turned[2], p[row]);
  }
}

TEST(Tileset, MayHaveItsFilesInAFolder) {
  const SpherePoints sphere(6000);
  Files plain = tiles_of(sphere.columns(), {.root_points = 20, .json_levels = 2});
  Files below = tiles_of(sphere.columns(), {.root_points = 20, .json_levels = 2, .folder = "tiles/x/"});
  const json root = json::parse(below.at("tileset.json"))["root"];
  EXPECT_EQ(root["content"]["uri"], "tiles/x/0-0.glb");
  EXPECT_EQ(root["children"][3]["content"]["uri"], "tiles/x/1-3.glb");
  EXPECT_EQ(root["children"][3]["children"][0]["content"]["uri"], "tiles/x/1-3.json");
  plain.erase("tileset.json");
  below.erase("tileset.json");
  EXPECT_EQ(plain, below) << "which are beside each other there";
  for (const auto& [name, bytes] : plain) EXPECT_TRUE(is_tile_name(name)) << name;
  for (const char* name :
       {"", "tileset.json", "0-0.png", "0-0.glb/", "../0-0.glb", "0-0.glb\n", "a-0.glb", "0-0xglb", "123-0.glb"}) {
    EXPECT_FALSE(is_tile_name(name)) << name;
  }
}

TEST(Tileset, HasNoTinyTilesWhereTheDensityIsFarFromEven) {
  // Half of the points have ranks far beyond their number.
  SpherePoints sphere(6000);
  for (std::size_t i = 0; i < sphere.ranks.size(); ++i) {
    if (sphere.ranks[i] >= 3000) sphere.ranks[i] *= 50'000;
  }
  const Files files = tiles_of(sphere.columns(), {.root_points = 100, .content = kFloats});
  std::size_t points = 0, tiles = 0;
  walk(files, json::parse(files.at("tileset.json"))["root"], 0, [&](const json&, int level, const std::vector<Place>& own) {
    EXPECT_LE(level, 4);
    points += own.size();
    tiles += own.empty() ? 0 : 1;
  });
  EXPECT_EQ(points, 6000U);
  EXPECT_LE(tiles, 1U + 4 + 16 + 64 + 256);
}

TEST(Tileset, IsTheSameEveryTime) {
  const SpherePoints sphere(3000);
  EXPECT_EQ(tiles_of(sphere.columns(), {.root_points = 64}), tiles_of(sphere.columns(), {.root_points = 64}));
}

TEST(Tileset, RefusesWhatCannotBeDivided) {
  const SpherePoints sphere(50);
  const auto refused = [](const PointColumns& columns, const TilesetOptions& options) {
    return std::string(make_tileset(columns, options, [](TileFile) { return absl::OkStatus(); }).message());
  };
  PointColumns columns = sphere.columns();
  columns.ranks = {};
  EXPECT_THAT(refused(columns, {}), ::testing::HasSubstr("no ranks"));
  EXPECT_THAT(refused({}, {}), ::testing::HasSubstr("no points"));
  EXPECT_THAT(refused(sphere.columns(), {.root_points = 0}), ::testing::HasSubstr("root_points = 0"));
  std::vector<std::uint32_t> ranks = sphere.ranks;
  ranks[4] = ranks[5];
  columns.ranks = ranks;
  EXPECT_THAT(refused(columns, {}), ::testing::HasSubstr("two points have the rank"));
  const absl::Status full = absl::ResourceExhaustedError("the disk is full");
  EXPECT_EQ(make_tileset(sphere.columns(), {}, [&](TileFile) { return full; }), full);
}

}  // namespace
}  // namespace curvecast::formats
