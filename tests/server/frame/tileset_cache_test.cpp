#include "server/frame/tileset_cache.h"

#include <gtest/gtest.h>

#include <string>

namespace curvecast::server {
namespace {

constexpr std::size_t kFile = 100'000;

std::shared_ptr<const Tileset> set_of(const std::string& session, const std::string& terms, const std::string& digest = "d") {
  auto set = std::make_shared<Tileset>();
  set->session_id = session;
  set->terms = terms;
  set->digest = digest;
  set->files.emplace("0-0.glb", std::string(kFile, 'x'));
  return set;
}

bool any(const Tileset&) { return true; }

TEST(TilesetCache, KeepsWhatWasUsedLast) {
  TilesetCache cache(3 * kFile + kFile / 2);
  for (const char* terms : {"1", "2", "3"}) cache.keep(set_of("s", terms));
  EXPECT_NE(cache.find("s", "1", any), nullptr);
  cache.keep(set_of("s", "4"));
  EXPECT_EQ(cache.find("s", "2", any), nullptr) << "was used longest ago";
  for (const char* terms : {"1", "3", "4"}) EXPECT_NE(cache.find("s", terms, any), nullptr) << terms;
  EXPECT_GT(cache.byte_size(), 3 * kFile);
  EXPECT_LT(cache.byte_size(), 3 * kFile + kFile / 2);
}

TEST(TilesetCache, KeepsTheLastOneWhateverItsSize) {
  TilesetCache cache(10);
  cache.keep(set_of("s", "1"));
  EXPECT_NE(cache.find("s", "1", any), nullptr);
  cache.keep(set_of("s", "2"));
  EXPECT_EQ(cache.find("s", "1", any), nullptr);
  EXPECT_NE(cache.find("s", "2", any), nullptr);
}

TEST(TilesetCache, CountsNoSetTwice) {
  TilesetCache cache(10 * kFile);
  cache.keep(set_of("s", "1"));
  const std::uint64_t once = cache.byte_size();
  cache.keep(set_of("s", "1"));
  EXPECT_EQ(cache.byte_size(), once);
  cache.keep(set_of("s", "1", "other"));
  EXPECT_EQ(cache.byte_size(), 2 * once) << "old tiles may still be asked for";
  EXPECT_EQ(cache.find("s", "1", [](const Tileset& set) { return set.digest == "d"; })->digest, "d");
  EXPECT_EQ(cache.find("s", "1", [](const Tileset& set) { return set.digest == "none"; }), nullptr);
}

TEST(TilesetCache, ForgetsSessionsAndAll) {
  TilesetCache cache(10 * kFile);
  cache.keep(set_of("s", "1"));
  cache.keep(set_of("t", "1"));
  cache.keep(set_of("s", "2"));
  cache.forget("s");
  EXPECT_EQ(cache.find("s", "1", any), nullptr);
  EXPECT_EQ(cache.find("s", "2", any), nullptr);
  const auto held = cache.find("t", "1", any);
  ASSERT_NE(held, nullptr);
  cache.clear();
  EXPECT_EQ(cache.find("t", "1", any), nullptr);
  EXPECT_EQ(cache.byte_size(), 0u);
  EXPECT_EQ(held->files.at("0-0.glb").size(), kFile) << "who has it goes on with it";
}

TEST(TilesetCache, KeepsNoMoreThanSomeDozens) {
  TilesetCache cache(std::uint64_t{1} << 40);
  for (int i = 0; i < 100; ++i) cache.keep(set_of("s", std::to_string(i)));
  EXPECT_EQ(cache.find("s", "0", any), nullptr);
  EXPECT_NE(cache.find("s", "99", any), nullptr);
  EXPECT_LT(cache.byte_size(), 70 * kFile);
}

}  // namespace
}  // namespace curvecast::server
