// The benchmarks that take one mesh, on a small one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "client/cli/bench/bench_report.h"
#include "client/cli/bench/growth.h"
#include "client/cli/bench/peak_memory.h"
#include "client/cli/bench/preprocess_bench.h"
#include "tests/support/shapes.h"

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;

const BenchResult* find(const BenchReport& report, const std::string& part) {
  for (const BenchResult& result : report.results) {
    if (result.name.find(part) != std::string::npos) return &result;
  }
  return nullptr;
}

TEST(BenchReport, ListsValuesReferencesAndRatios) {
  const BenchReport report{"name", {{"plain", 3, "s"}, {"compared", 3, "s", 4}}, {"A note."}};
  const Json json = bench_json(report);
  EXPECT_EQ(json["name"], "name");
  EXPECT_NE(json["machine"], "");
  EXPECT_FALSE(json["results"][0].contains("ratio"));
  EXPECT_EQ(json["results"][1]["case"], "compared");
  EXPECT_EQ(json["results"][1]["unit"], "s");
  EXPECT_EQ(json["results"][1]["reference"], 4);
  EXPECT_EQ(json["results"][1]["ratio"], 0.75);
  EXPECT_THAT(bench_text(report), HasSubstr("0.750"));
  EXPECT_THAT(bench_text(report), HasSubstr("A note."));
}

TEST(PreprocessBench, ComparesWithCgalOnTheSameDiscs) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::torus(24, 12));
  const auto report = bench_preprocess({"torus.off", off}, {.repeats = 2, .points = 1000}, {});
  ASSERT_TRUE(report.ok()) << report.status();
  for (const char* name : {"1 thread: cut + parameterise / CGAL (incomplete LU)", "1 thread: total / CGAL (diagonal)"}) {
    const BenchResult* result = find(*report, name);
    ASSERT_NE(result, nullptr) << name;
    EXPECT_GT(result->value, 0);
    EXPECT_GT(result->reference.value_or(0), 0);
  }
  EXPECT_NE(find(*report, "1 thread: curve"), nullptr);
  EXPECT_EQ(find(*report, "refused discs"), nullptr);
  EXPECT_FALSE(bench_preprocess({"bad.off", {}}, {}, {}).ok());
}

TEST(Growth, MeasuresEverySize) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::torus(24, 12));
  const auto report = bench_growth({"torus.off", off}, {.levels = 2, .points = 1000}, {});
  ASSERT_TRUE(report.ok()) << report.status();
  for (const char* name : {"576 faces: total", "2304 faces: parameterise", "9216 faces: total exponent"}) {
    EXPECT_NE(find(*report, name), nullptr) << name;
  }
  EXPECT_EQ(find(*report, "576 faces: total exponent"), nullptr);
  EXPECT_EQ(bench_growth({"torus.off", off}, {.levels = 7}, {}).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(PeakMemory, SeesWhatWasHeldForAMoment) {
  if (!reset_peak_memory()) GTEST_SKIP() << "this system does not let a process reset its peak memory";
  const std::uint64_t before = peak_memory();
  constexpr std::size_t kBytes = std::size_t{64} << 20;
  { std::vector<char> block(kBytes, 1); }
  EXPECT_GE(peak_memory(), before + kBytes / 2);
  ASSERT_TRUE(reset_peak_memory());
  EXPECT_LT(peak_memory(), before + kBytes / 2);
}

}  // namespace
}  // namespace curvecast::cli
