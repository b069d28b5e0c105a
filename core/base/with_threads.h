// A part of a computation on as many threads as an ExecutionContext says.
#pragma once

#include <tbb/task_arena.h>

#include <utility>

#include "core/base/execution_context.h"

namespace curvecast {

/// Calls the function in an arena of so many threads, and returns what it does.
template <typename Function>
auto with_threads(const ExecutionContext& context, Function&& function) {
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  return arena.execute(std::forward<Function>(function));
}

}  // namespace curvecast
