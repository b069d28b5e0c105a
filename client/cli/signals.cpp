#include "client/cli/signals.h"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <utility>

#include "client/cli/exit_status.h"

namespace curvecast::cli {
namespace {

sigset_t set_of(std::initializer_list<int> numbers) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : numbers) sigaddset(&signals, number);
  return signals;
}

void block(const sigset_t& signals) { pthread_sigmask(SIG_BLOCK, &signals, nullptr); }

}  // namespace

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
