#include "client/python/native/interruptible.h"

#include <atomic>
#include <chrono>
#include <exception>
#include <string_view>
#include <thread>
#include <utility>

#include "core/base/mutex.h"

namespace curvecast::python {
namespace {

namespace nb = nanobind;

constexpr auto kLookEvery = std::chrono::milliseconds(50);  // for signals and progress

/// What the thread that works tells the one that waits.
class Report {
 public:
  void tell(std::string_view stage, double fraction) {
    const MutexLock lock(mutex_);
    stage_ = stage;
    fraction_ = fraction;
    is_new_ = true;
  }
  void end() {
    const MutexLock lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  /// Returns whether the work has ended, after a while at most.
  bool wait() {
    const MutexLock lock(mutex_);
    const auto deadline = std::chrono::steady_clock::now() + kLookEvery;
    while (!ended_ && changed_.wait_until(mutex_, deadline)) {
    }
    return ended_;
  }
  void wait_for_end() {
    const MutexLock lock(mutex_);
    while (!ended_) changed_.wait(mutex_);
  }
  /// Calls `on_progress` with what was told last, unless it knows that.
  void pass_on(const nb::object& on_progress) {
    std::string_view stage;
    double fraction = 0;
    {
      const MutexLock lock(mutex_);
      if (!std::exchange(is_new_, false)) return;
      stage = stage_;
      fraction = fraction_;
    }
    on_progress(nb::str(stage.data(), stage.size()), fraction);
  }

 private:
  Mutex mutex_;
  CondVar changed_;
  std::string_view stage_ ABSL_GUARDED_BY(mutex_);  // of a literal
  double fraction_ ABSL_GUARDED_BY(mutex_) = 0;
  bool is_new_ ABSL_GUARDED_BY(mutex_) = false, ended_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace

void run(int threads, const nb::object& on_progress, const std::function<void(const ExecutionContext& context)>& work) {
  std::atomic<bool> cancel = false;
  Report report;
  ExecutionContext context{.cancel = &cancel, .threads = threads};
  if (!on_progress.is_none()) {
    context.on_progress = [&report](std::string_view stage, double fraction) { report.tell(stage, fraction); };
  }
  std::thread worker([&] {
    work(context);
    report.end();
  });
  std::exception_ptr failure;
  for (bool ended = false; !ended;) {
    {
      const nb::gil_scoped_release released;
      ended = report.wait();
    }
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (!on_progress.is_none()) report.pass_on(on_progress);
    } catch (...) {
      failure = std::current_exception();
      cancel = true;
      const nb::gil_scoped_release released;
      report.wait_for_end();
      ended = true;
    }
  }
  {
    const nb::gil_scoped_release released;
    worker.join();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace curvecast::python
