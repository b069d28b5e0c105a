#include "client/cli/signals.h"

#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <iterator>
#include <utility>

#include "client/cli/exit_status.h"

namespace curvecast::cli {
namespace {

constexpr unsigned kMostReport = 3;  // seconds, should what crashed hold what its report takes

sigset_t set_of(std::initializer_list<int> numbers) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : numbers) sigaddset(&signals, number);
  return signals;
}

void block(const sigset_t& signals) { pthread_sigmask(SIG_BLOCK, &signals, nullptr); }

[[maybe_unused]] void on_crash(int number) {
  ::alarm(kMostReport);
  const char* const name = sigabbrev_np(number);
  for (const char* text : {"curvecast: crashed, SIG", name, "; addr2line tells what stands where:\n"}) {
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) break;
  }
  void* frames[64] = {};
  ::backtrace_symbols_fd(frames, ::backtrace(frames, std::size(frames)), STDERR_FILENO);
  ::raise(number);  // which ends the process once this returns, as it would have without it
}

}  // namespace

void report_crashes() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  void* first = nullptr;
  ::backtrace(&first, 1);  // loads what it takes, which a handler must not
  struct sigaction action = {};
  action.sa_handler = on_crash;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (const int number : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT}) sigaction(number, &action, nullptr);
#endif
}

SignalWatcher::SignalWatcher() {
  const sigset_t signals = set_of({SIGINT, SIGTERM});
  block(signals);
  thread_ = std::thread([this, signals] {
    block(set_of({SIGHUP}));  // which ends the process by another thread, unless they hold it back
    while (true) {
      int signal = 0;
      if (sigwait(&signals, &signal) != 0 || done_) return;
      if (!stop_.request_stop()) _exit(kInterrupted);
    }
  });
}

SignalWatcher::~SignalWatcher() {
  done_ = true;
  // Wakes it: the signal is blocked, and sigwait() takes it.
  pthread_kill(thread_.native_handle(), SIGTERM);  // NOLINT(bugprone-bad-signal-to-kill-thread)
  thread_.join();
}

bool has_terminal() {
  const int terminal = ::open("/dev/tty", O_RDONLY | O_NOCTTY | O_CLOEXEC);
  if (terminal < 0) return false;
  ::close(terminal);
  return true;
}

void HangUpWatcher::hold_back() { block(set_of({SIGHUP})); }

HangUpWatcher::HangUpWatcher(std::function<void()> on_hang_up)
    : thread_([this, on_hang_up = std::move(on_hang_up)] {
        const sigset_t signals = set_of({SIGHUP});
        int signal = 0;
        while (sigwait(&signals, &signal) == 0 && !done_) on_hang_up();
      }) {}

HangUpWatcher::~HangUpWatcher() {
  done_ = true;
  pthread_kill(thread_.native_handle(), SIGHUP);  // NOLINT(bugprone-bad-signal-to-kill-thread)
  thread_.join();
}

}  // namespace curvecast::cli
