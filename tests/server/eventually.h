// Waiting for what a server does in its own time, without betting on how long that takes.
#pragma once

#include <chrono>
#include <thread>

namespace curvecast::server {

/// Whether the condition comes true: false after four minutes, which only a broken server takes, and which leave a test time to
/// say so.
template <class Condition>
bool eventually(const Condition& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(4);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace curvecast::server
