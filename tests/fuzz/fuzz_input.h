// What all fuzzers have in common: they take inputs, one after the other, each within bounds.
#pragma once

#include <cstddef>
#include <cstdint>

namespace curvecast::fuzzing {

/// Each fuzzer defines it: takes an input, and aborts where a promise is broken. The bytes lie in memory of their own, behind
/// which nothing may be read.
void take_input(const std::uint8_t* data, std::size_t size);

}  // namespace curvecast::fuzzing
