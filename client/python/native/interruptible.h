// Runs work while Python goes on: other threads run, Ctrl-C ends the work, and its progress is told on the thread that waits.
#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <nanobind/nanobind.h>

#include <functional>
#include <utility>

#include "core/base/execution_context.h"
#include "server/base/status_from_exceptions.h"

namespace curvecast::python {

/// Raises `Error(code, message)` of this module. `code`: as gRPC numbers them.
[[noreturn]] void raise(const absl::Status& status);

/// Calls work(context) on a thread of its own and waits for it without the interpreter's lock. `on_progress`: None, or called
/// with stage and fraction on this thread. An exception of it, or of a signal, cancels the work and is passed on.
void run(int threads, const nanobind::object& on_progress, const std::function<void(const ExecutionContext& context)>& work);

/// Does the same with work that returns a StatusOr, and returns its value; raises its error.
template <typename Work>
auto run_or_raise(int threads, const nanobind::object& on_progress, const Work& work) {
  decltype(work(std::declval<const ExecutionContext&>())) result = absl::UnknownError("the work did not run");
  run(threads, on_progress,
      [&](const ExecutionContext& context) { result = server::status_from_exceptions([&] { return work(context); }); });
  if (!result.ok()) raise(result.status());
  return *std::move(result);
}

}  // namespace curvecast::python
