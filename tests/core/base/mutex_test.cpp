#include "core/base/mutex.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

namespace curvecast {
namespace {

struct Counter {
  Mutex mutex;
  CondVar changed;
  int value ABSL_GUARDED_BY(mutex) = 0;
};

TEST(Mutex, LetsOneThreadInAtATime) {
  constexpr int kThreads = 4, kRounds = 10'000;
  Counter counter;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < kRounds; ++i) {
          const MutexLock lock(counter.mutex);
          ++counter.value;
        }
      });
    }
  }
  const MutexLock lock(counter.mutex);
  EXPECT_EQ(counter.value, kThreads * kRounds);
}

TEST(Mutex, ALockCanPause) {
  Counter counter;
  MutexLock lock(counter.mutex);
  counter.value = 1;
  lock.unlock();
  std::jthread([&] {
    const MutexLock other(counter.mutex);  // waits for ever where unlock() does nothing
    ++counter.value;
  }).join();
  lock.lock();
  EXPECT_EQ(counter.value, 2);
}

TEST(CondVar, WakesWhoWaits) {
  Counter counter;
  std::jthread other([&] {
    MutexLock lock(counter.mutex);
    while (counter.value != 1) counter.changed.wait(counter.mutex);
    counter.value = 2;
    counter.changed.notify_one();
  });
  MutexLock lock(counter.mutex);
  counter.value = 1;
  counter.changed.notify_all();
  while (counter.value != 2) counter.changed.wait(counter.mutex);
  lock.unlock();  // held again after the wait
}

TEST(CondVar, StopsWaitingAtTheDeadline) {
  Counter counter;
  const MutexLock lock(counter.mutex);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
  while (counter.changed.wait_until(counter.mutex, deadline)) continue;
  EXPECT_GE(std::chrono::steady_clock::now(), deadline);
  ++counter.value;  // held again
}

}  // namespace
}  // namespace curvecast
