// Looks whether a port of this process answers.
#pragma once

#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "server/net/wake_up.h"

namespace curvecast::server {

/// Connects to a port once a second, on a thread of its own, and hangs up. Whatever comes back, be it the end of the connection,
/// shows that somebody is there: a port that nobody serves accepts connections too, as many as the system lets wait. Thread-safe.
class PortProbe {
 public:
  struct Options {
    std::chrono::milliseconds interval{1000};    // from one connection to the next
    std::chrono::milliseconds patience{10'000};  // without an answer for so long, nobody is there
  };

  /// `listener` is a socket that listens: its address is connected to, the loopback where it listens on all addresses.
  explicit PortProbe(int listener) : PortProbe(listener, Options()) {}
  PortProbe(int listener, const Options& options);
  PortProbe(const PortProbe&) = delete;
  PortProbe& operator=(const PortProbe&) = delete;
  ~PortProbe();

  /// Whether somebody has been there of late. At once.
  bool answers() const;

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  /// Connects once.
  bool ask() const;
  /// Waits for events of a descriptor; false when the time is over or this ends.
  bool wait(int descriptor, short events, Clock::time_point deadline) const;

  const Options options_;
  sockaddr_storage address_ = {};
  socklen_t address_size_ = sizeof address_;
  std::atomic<Clock::time_point> answered_ = Clock::now();
  const WakeUp wake_up_;
  std::thread thread_;
};

}  // namespace curvecast::server
