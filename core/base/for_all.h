// The same work on many things at once, on the threads that an ExecutionContext says.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

#include "core/base/execution_context.h"

namespace curvecast {

/// Calls work(i) for all i below n, in any order, several at once; returns when all are done.
template <typename Work>
void for_all(const ExecutionContext& context, std::size_t n, const Work& work) {
  if (context.for_all) {
    context.for_all(n, work);
    return;
  }
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, n, work); });
}

}  // namespace curvecast
