// Waiting for what a server does in its own time, without betting on how long that takes.
#pragma once

#include <chrono>
#include <thread>

namespace curvecast::server {

/// Whether the condition comes true: false after ten minutes, which only a broken server takes.
template <class Condition>
bool eventually(const Condition& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace curvecast::server
