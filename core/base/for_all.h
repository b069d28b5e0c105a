// The same work on many things at once, on the threads that an ExecutionContext says.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
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

/// Calls work(begin, end) for all of [0, n) in blocks of `block` things, several at once, in the arena of the caller. Once the
/// context is cancelled it leaves out the blocks that have not begun: what they were to make is missing then.
template <typename Work>
void for_blocks(const ExecutionContext& context, std::size_t n, std::size_t block, const Work& work) {
  tbb::parallel_for(std::size_t{0}, (n + block - 1) / block, [&](std::size_t b) {
    if (!context.cancelled()) work(b * block, std::min((b + 1) * block, n));
  });
}

/// The same, one block after the other.
template <typename Work>
void for_blocks_in_turn(const ExecutionContext& context, std::size_t n, std::size_t block, const Work& work) {
  for (std::size_t begin = 0; begin < n && !context.cancelled(); begin += block) work(begin, std::min(begin + block, n));
}

}  // namespace curvecast
