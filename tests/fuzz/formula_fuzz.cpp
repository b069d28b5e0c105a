// Formulas of densities, at the places of a small curve or, where the first byte says so, of one on which long formulas cost more
// than is allowed.
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/density/expression.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_input.h"

namespace curvecast::fuzzing {
namespace {

constexpr std::size_t kFew = 64, kMany = 150'000;  // places: kMany times a long formula is too much
constexpr unsigned kOneInSoMany = 16;              // is of many places
constexpr auto kMostWork = std::chrono::milliseconds(20);

SurfaceCurve make_curve(std::size_t places) {
  SurfaceCurve curve;
  curve.resize(places);
  curve.origin = Vec3d(1, 2, 3);
  curve.scalars.resize(2);
  curve.scalars[0].name = "heat";
  curve.scalars[1].name = "sin";  // a function's name
  for (ScalarColumn& scalar : curve.scalars) scalar.values.resize(places);
  for (std::size_t l = 0; l < places; ++l) {
    const auto some = [l](std::uint64_t stream) { return static_cast<float>(2 * random_unit(stream, l) - 1); };
    curve.x[l] = some(1), curve.y[l] = some(2), curve.z[l] = some(3);
    curve.nx[l] = some(4), curve.ny[l] = some(5), curve.nz[l] = some(6);
    curve.curvature_min[l] = some(7), curve.curvature_max[l] = some(8);
    for (ScalarColumn& scalar : curve.scalars) scalar.values[l] = some(9);
  }
  return curve;
}

const SurfaceCurve few = make_curve(kFew), many = make_curve(kMany);

absl::Status evaluate(const SurfaceCurve& curve, const std::string& text, std::span<float> values) {
  static tbb::task_arena arena(1);  // one thread: the same every time
  WorkLimit limit(kMostWork);
  return arena.execute([&] { return evaluate_expression(curve, text, values, {.limit = &limit}); });
}

}  // namespace

void take_input(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const absl::Status checked = check_expression(text);
  expect(checked.ok() || absl::IsInvalidArgument(checked), checked.ToString());
  const SurfaceCurve& curve = data[0] % kOneInSoMany == 0 ? many : few;
  // Used again by the next input: so many new values take longer than all else.
  static std::vector<float> few_values(kFew), many_values(kMany);
  std::vector<float>& values = &curve == &few ? few_values : many_values;
  const absl::Status status = evaluate(curve, text, values);
  // Of several faults each may name another one.
  expect(absl::IsInvalidArgument(status) || (checked.ok() && (status.ok() || absl::IsDeadlineExceeded(status))),
         checked.ToString() + " but then " + status.ToString());
  expect(std::ranges::all_of(status.message(), [](char c) { return c >= ' ' && c <= '~'; }), "a message that is no plain text");
  if (!status.ok() || &curve != &few) return;
  // A value depends on its place alone.
  std::vector<float> some(kFew / 2);
  expect(evaluate(curve, text, some).ok(), "not for fewer places");
  expect(std::memcmp(some.data(), values.data(), some.size() * sizeof(float)) == 0, "another value at the same place");
}

}  // namespace curvecast::fuzzing
