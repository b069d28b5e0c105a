#include "server/base/crew.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace curvecast::server {
namespace {

/// How often each of n was worked on.
std::vector<int> counts_of(Crew& crew, std::size_t n) {
  std::vector<std::atomic<int>> counts(n);
  crew.for_all(n, [&](std::size_t i) { ++counts[i]; });
  return {counts.begin(), counts.end()};
}

TEST(Crew, WorksOnEachOnce) {
  for (const int helpers : {0, 1, 3}) {
    Crew crew(helpers);
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{1000}}) {
      EXPECT_EQ(counts_of(crew, n), std::vector<int>(n, 1));
    }
  }
}

TEST(Crew, HelpersTakeTheirPart) {
  Crew crew(2);
  std::atomic<int> inside = 0;
  // Ends only once three threads are at it.
  crew.for_all(3, [&](std::size_t) {
    ++inside;
    while (inside < 3) std::this_thread::yield();
  });
  EXPECT_EQ(inside, 3);
}

TEST(Crew, SeveralCallersShareTheHelpers) {
  Crew crew(2);
  std::vector<std::jthread> callers;
  for (int c = 0; c < 4; ++c) {
    callers.emplace_back([&] {
      for (int i = 0; i < 50; ++i) EXPECT_EQ(counts_of(crew, 40), std::vector<int>(40, 1));
    });
  }
}

TEST(Crew, AfterStopTheCallerWorksAlone) {
  Crew crew(2);
  crew.stop();
  const auto self = std::this_thread::get_id();
  crew.for_all(20, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), self); });
}

}  // namespace
}  // namespace curvecast::server
