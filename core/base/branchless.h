// Minimum and maximum of doubles by value: one instruction each, where std::min and std::max, which take references, become jumps
// that nobody can predict. NaN: the second argument.
#pragma once

namespace curvecast {

[[gnu::always_inline]] constexpr double lesser(double a, double b) { return a < b ? a : b; }
[[gnu::always_inline]] constexpr double greater(double a, double b) { return a > b ? a : b; }
[[gnu::always_inline]] constexpr double clamped(double x, double low, double high) { return lesser(greater(x, low), high); }

}  // namespace curvecast
