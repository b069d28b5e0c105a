#include "server/frame/workspaces.h"

#include <gtest/gtest.h>

#include <thread>

namespace curvecast::server {
namespace {

TEST(Workspaces, LendsWhatCameBack) {
  Workspaces workspaces;
  const ViewWorkspace* first = nullptr;
  {
    const Workspaces::Lease one = workspaces.lease(), two = workspaces.lease();
    EXPECT_NE(one.get(), two.get());
    first = one.get();
    EXPECT_EQ(workspaces.idle(), 0u);
  }
  EXPECT_EQ(workspaces.idle(), 2u);
  EXPECT_EQ(workspaces.lease().get(), first) << "the one that came back last, whose memory is warm";
}

TEST(Workspaces, KeepNoLargeOnesAndNotMany) {
  Workspaces workspaces;
  {
    const Workspaces::Lease large = workspaces.lease();
    large->equalised.sequence.resize(std::size_t{10} << 20);
  }
  EXPECT_EQ(workspaces.idle(), 0u);
  {
    std::vector<Workspaces::Lease> many;
    for (int i = 0; i < 100; ++i) many.push_back(workspaces.lease());
  }
  EXPECT_LE(workspaces.idle(), 16u);
}

TEST(Workspaces, CountAndFreeWhatIsIdle) {
  Workspaces workspaces;
  {
    const Workspaces::Lease lease = workspaces.lease();
    lease->equalised.sequence.resize(1000);
    EXPECT_EQ(workspaces.byte_size(), 0u) << "it is lent";
  }
  EXPECT_GE(workspaces.byte_size(), 1000 * sizeof(double));
  const Workspaces::Lease lent = workspaces.lease();
  workspaces.clear();
  EXPECT_EQ(lent->equalised.sequence.size(), 1000u);
  EXPECT_EQ(workspaces.byte_size(), 0u);
}

TEST(Workspaces, ServeManyThreads) {
  Workspaces workspaces;
  std::vector<std::jthread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 1000; ++i) {
        const Workspaces::Lease lease = workspaces.lease();
        lease->equalised.sequence.assign(10, static_cast<double>(t));
        for (const double value : lease->equalised.sequence) ASSERT_EQ(value, static_cast<double>(t));
      }
    });
  }
  threads.clear();
  EXPECT_LE(workspaces.idle(), 4u);
}

}  // namespace
}  // namespace curvecast::server
