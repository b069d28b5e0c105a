// How much memory a piece of code takes at once. Whoever links this has operator new and delete replaced: it belongs into test
// programs of their own.
#pragma once

#include <cstddef>

namespace curvecast::testing {

/// Counts what operator new gives out, in all threads, while it lives. One at a time.
class CountedMemory {
 public:
  CountedMemory();
  /// The most bytes that were in use at once, beyond those at the beginning.
  std::size_t peak() const;
};

}  // namespace curvecast::testing
