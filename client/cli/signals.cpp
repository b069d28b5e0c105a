#include "client/cli/signals.h"

#include <pthread.h>
#include <unistd.h>

#include <csignal>

#include "client/cli/exit_status.h"

namespace curvecast::cli {

SignalWatcher::SignalWatcher() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::thread([this, signals] {
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

}  // namespace curvecast::cli
