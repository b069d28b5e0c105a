// Four floats at once, rounded as one by one: SSE2 where there is any, which is every x86-64 processor.
#pragma once

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace curvecast {

#ifdef __SSE2__

struct Float4 {
  __m128 v;

  static Float4 all(float value) { return {_mm_set1_ps(value)}; }
  /// `from` and `to` are aligned to 16 bytes.
  static Float4 load(const float* from) { return {_mm_load_ps(from)}; }
  void store(float* to) const { _mm_store_ps(to, v); }

  friend Float4 operator+(Float4 a, Float4 b) { return {_mm_add_ps(a.v, b.v)}; }
  friend Float4 operator-(Float4 a, Float4 b) { return {_mm_sub_ps(a.v, b.v)}; }
  friend Float4 operator*(Float4 a, Float4 b) { return {_mm_mul_ps(a.v, b.v)}; }
};

/// b where either is not a number, and so is min.
inline Float4 max(Float4 a, Float4 b) { return {_mm_max_ps(a.v, b.v)}; }
inline Float4 min(Float4 a, Float4 b) { return {_mm_min_ps(a.v, b.v)}; }
/// Bit i: a[i] <= b[i].
inline unsigned less_or_equal(Float4 a, Float4 b) { return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(a.v, b.v))); }
/// The least of the four, four times.
inline Float4 least(Float4 a) {
  a = min(a, {_mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(1, 0, 3, 2))});
  return min(a, {_mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(2, 3, 0, 1))});
}

#else

struct Float4 {
  float v[4];

  static Float4 all(float value) { return {{value, value, value, value}}; }
  static Float4 load(const float* from) { return {{from[0], from[1], from[2], from[3]}}; }
  void store(float* to) const {
    for (int i = 0; i < 4; ++i) to[i] = v[i];
  }

  template <typename Function>
  static Float4 each(Function&& function) {
    return {{function(0), function(1), function(2), function(3)}};
  }
  friend Float4 operator+(const Float4& a, const Float4& b) {
    return each([&](int i) { return a.v[i] + b.v[i]; });
  }
  friend Float4 operator-(const Float4& a, const Float4& b) {
    return each([&](int i) { return a.v[i] - b.v[i]; });
  }
  friend Float4 operator*(const Float4& a, const Float4& b) {
    return each([&](int i) { return a.v[i] * b.v[i]; });
  }
};

inline Float4 max(const Float4& a, const Float4& b) {
  return Float4::each([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
inline Float4 min(const Float4& a, const Float4& b) {
  return Float4::each([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline unsigned less_or_equal(const Float4& a, const Float4& b) {
  unsigned bits = 0;
  for (int i = 0; i < 4; ++i) bits |= static_cast<unsigned>(a.v[i] <= b.v[i]) << i;
  return bits;
}
inline Float4 least(const Float4& a) {
  float result = a.v[0];
  for (int i = 1; i < 4; ++i) result = a.v[i] < result ? a.v[i] : result;
  return Float4::all(result);
}

#endif

}  // namespace curvecast
