// What all fuzzers have in common: they take inputs, one after the other, each within bounds.
#pragma once

#include <cstddef>
#include <cstdint>

namespace curvecast::fuzzing {

/// Each fuzzer defines it: takes an input, and aborts where a promise is broken. The bytes lie in memory of their own, behind
/// which nothing may be read.
void take_input(const std::uint8_t* data, std::size_t size);

/// Of all threads since the process began, seconds.
double processor_time();

/// Work that takes many times as long as the rest of an input: it may have a tenth of the processor's time. An input that is
/// tried by itself has it done.
class DearWork {
 public:
  bool is_due() const { return spent_ <= processor_time() / 10; }
  template <typename Work>
  auto run(const Work& work) {
    const double before = processor_time();
    auto result = work();
    spent_ += processor_time() - before;
    return result;
  }

 private:
  double spent_ = 0;  // seconds
};

}  // namespace curvecast::fuzzing
