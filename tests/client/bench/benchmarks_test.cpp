// The benchmarks that take one mesh, on a small one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "client/bench/areas.h"
#include "client/bench/bench_report.h"
#include "client/bench/growth.h"
#include "client/bench/mappers.h"
#include "client/bench/peak_memory.h"
#include "client/bench/preprocess_bench.h"
#include "client/bench/sample_bench.h"
#include "client/bench/stream_bench.h"
#include "tests/support/shapes.h"

namespace curvecast::cli::bench {
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
  EXPECT_GT(find(*report, "9216 faces: total")->reference.value_or(0), 0);  // a chain of levels of detail
  EXPECT_EQ(bench_growth({"torus.off", off}, {.levels = 7}, {}).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(SampleBench, MeasuresEveryStageBesideReading) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::torus(24, 12));
  const auto report = bench_sample({"torus.off", off}, {.repeats = 3, .points = 1000, .view_points = 500}, {});
  ASSERT_TRUE(report.ok()) << report.status();
  ASSERT_NE(find(*report, "read positions"), nullptr);
  const double read = find(*report, "read positions")->value;
  for (const std::string set : {"N = 1000", "curvature, N = 1000", "view, N = 500", "curvature x view, N = 500"}) {
    for (const char* stage : {"", ": density", ": equalise", ": gather"}) {
      const BenchResult* result = find(*report, set + stage);
      ASSERT_NE(result, nullptr) << set << stage;
      EXPECT_EQ(result->reference, read);
      EXPECT_EQ(result->unit, "ms");
    }
  }
  EXPECT_NE(find(*report, "view, N = 500, fresh memory"), nullptr);
  EXPECT_LE(find(*report, "curve")->value, 64 * 1.1) << "bytes for each vertex";
  EXPECT_FALSE(bench_sample({"torus.off", off}, {.points = 100, .view_points = 0}, {}).ok());
}

TEST(StreamBench, MeasuresOneClientAndCrowds) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::torus(24, 12));
  const StreamBenchOptions options{
      .points = 3000, .crowd_points = 500, .clients = 8, .seconds = 0.5, .rate = 20, .idle = 5, .command = CURVECAST_COMMAND};
  const auto report = bench_stream({"torus.off", off}, options, {});
  ASSERT_TRUE(report.ok()) << report.status();
  const BenchResult* delta = find(*report, "deltas by 1 degree: frame");
  ASSERT_NE(delta, nullptr);
  EXPECT_GT(delta->value, 0);
  EXPECT_LT(delta->value, 0.5 * delta->reference.value_or(0));
  EXPECT_GT(find(*report, "key frames: latency p50")->value, 0);
  for (const char* name : {"1 clients, N = 500", "8 clients, N = 500"}) {
    const BenchResult* latency = find(*report, name);
    ASSERT_NE(latency, nullptr) << name;
    EXPECT_GT(latency->value, 0);
  }
  EXPECT_NE(find(*report, "5 clients with 500 points that do nothing"), nullptr);
  EXPECT_NE(find(*report, "beside clients that behave badly: latency p99"), nullptr);
  EXPECT_FALSE(bench_stream({"bad.off", {}}, {.command = CURVECAST_COMMAND}, {}).ok());
  EXPECT_TRUE(absl::IsUnavailable(bench_stream({"torus.off", off}, {.command = "/bin/false"}, {}).status()));
  EXPECT_TRUE(absl::IsUnavailable(bench_stream({"torus.off", off}, {.command = "/no/such/command"}, {}).status()));
}

TEST(PeakMemory, SeesWhatWasHeldForAMoment) {
  if (!reset_peak_memory()) GTEST_SKIP() << "this system does not let a process reset its peak memory";
  const std::uint64_t before = peak_memory();
  constexpr std::size_t kBytes = std::size_t{64} << 20;
  // From the system and back to it: a sanitiser holds back what is freed.
  void* const block = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(block, MAP_FAILED);
  std::memset(block, 1, kBytes);
  munmap(block, kBytes);
  EXPECT_GE(peak_memory(), before + kBytes / 2);
  ASSERT_TRUE(reset_peak_memory());
  EXPECT_LT(peak_memory(), before + kBytes / 2);
}

TEST(MappersBench, ComparesTheMappers) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::jittered(curvecast::testing::torus(24, 12), 0.02));
  const auto report = bench_mappers({"torus.off", off}, {.repeats = 2, .points = 1000}, {});
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_GT(find(*report, "exact")->value, 0);
  EXPECT_GT(find(*report, "ID buffer")->reference.value_or(0), 0);
  EXPECT_GT(find(*report, "ID buffer: sections")->value, 0);
  EXPECT_LT(find(*report, "centres with different triangles")->value, 1);
  EXPECT_FALSE(bench_mappers({"bad.off", {}}, {}, {}).ok());
}

TEST(AreasBench, ComparesTheAreaElements) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::torus(60, 30));
  const auto report = bench_areas({"torus.off", off}, {.runs = 3, .regions = 50, .points = 2000}, {});
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_LT(std::abs(find(*report, "exact: error of the sum")->value), 1e-4);
  EXPECT_LT(std::abs(find(*report, "Voronoi: error of the sum")->value), 1);
  EXPECT_NEAR(find(*report, "random samples: RMS gradient")->value, -0.5, 0.1);
  for (const char* name : {"exact: RMS gradient", "Voronoi: RMS gradient"}) EXPECT_LT(find(*report, name)->value, -0.6) << name;
  EXPECT_GT(find(*report, "random samples: RMS, all N")->value, 1.5);
  EXPECT_FALSE(bench_areas({"bad.off", {}}, {}, {}).ok());
}

}  // namespace
}  // namespace curvecast::cli::bench
