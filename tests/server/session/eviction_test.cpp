#include "server/session/eviction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::vector<Resident> kResidents = {
    {"b", 20, 100, true}, {"a", 10, 50, true}, {"busy", 5, 300, false}, {"c", 30, 10, true}};

TEST(Eviction, TakesWhatWouldBeLostLast) {
  std::vector<Resident> residents = kResidents;
  residents[1].is_unsaved = true;  // "a", the least recently used
  EXPECT_THAT(choose_evicted(residents, {3, 460}).ids, ElementsAre("b"));
  EXPECT_THAT(choose_evicted(residents, {2, 460}).ids, ElementsAre("b", "c"));
  EXPECT_THAT(choose_evicted(residents, {1, 460}).ids, ElementsAre("b", "c", "a")) << "there is no other way";
}

TEST(Eviction, TakesTheLeastRecentlyUsed) {
  EXPECT_THAT(choose_evicted(kResidents, {4, 460}).ids, IsEmpty());
  EXPECT_THAT(choose_evicted(kResidents, {3, 460}).ids, ElementsAre("a"));
  EXPECT_THAT(choose_evicted(kResidents, {2, 460}).ids, ElementsAre("a", "b"));
}

TEST(Eviction, TakesNoMoreThanTheBytesAskFor) {
  EXPECT_THAT(choose_evicted(kResidents, {10, 459}).ids, ElementsAre("a"));
  EXPECT_THAT(choose_evicted(kResidents, {10, 400}).ids, ElementsAre("a", "b"));
  EXPECT_TRUE(choose_evicted(kResidents, {10, 310}).is_enough);
}

TEST(Eviction, LeavesThoseInUseAndSaysThatItIsNotEnough) {
  const Eviction all = choose_evicted(kResidents, {0, 0});
  EXPECT_THAT(all.ids, ElementsAre("a", "b", "c"));
  EXPECT_FALSE(all.is_enough);
  EXPECT_EQ(all.sessions, 1u);
  EXPECT_EQ(all.bytes, 300u);
  EXPECT_FALSE(choose_evicted(kResidents, {10, 299}).is_enough);
  EXPECT_TRUE(choose_evicted({}, {0, 0}).is_enough);
}

}  // namespace
}  // namespace curvecast::server
