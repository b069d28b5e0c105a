// Ctrl-C and SIGTERM as a stop token, SIGHUP as a call, and what is told where a program crashes.
#pragma once

#include <atomic>
#include <functional>
#include <stop_token>
#include <thread>

namespace curvecast::cli {

/// From now on a crash (SIGSEGV, SIGABRT and the like) writes to standard error which signal it was and the addresses of the
/// calls that led there, before the process ends by that signal as it would have. Not under sanitisers, which tell more.
void report_crashes();

/// To be made before any other thread: it blocks the signals for the whole process and waits for them on a thread of its own. The
/// first SIGINT or SIGTERM requests stop, the second ends the process at once with status 130.
class SignalWatcher {
 public:
  SignalWatcher();
  SignalWatcher(const SignalWatcher&) = delete;
  SignalWatcher& operator=(const SignalWatcher&) = delete;
  ~SignalWatcher();

  std::stop_token token() const { return stop_.get_token(); }
  bool interrupted() const { return stop_.stop_requested(); }

 private:
  std::stop_source stop_;
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

/// Whether this process belongs to a terminal, whose end SIGHUP tells then. Services have none; to them it is a word of others.
bool has_terminal();

/// Calls a function with each SIGHUP, on a thread of its own, where otherwise that would end the process.
class HangUpWatcher {
 public:
  /// From now on the signal waits for a watcher. To be called before any other thread is made than the SignalWatcher's.
  static void hold_back();

  explicit HangUpWatcher(std::function<void()> on_hang_up);
  HangUpWatcher(const HangUpWatcher&) = delete;
  HangUpWatcher& operator=(const HangUpWatcher&) = delete;
  ~HangUpWatcher();

 private:
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

}  // namespace curvecast::cli
