#include "client/bench/corpus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>

#include "client/bench/corpus_table.h"
#include "tests/support/shapes.h"

namespace curvecast::cli::bench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CorpusTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_ + "/below"); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, const std::string& bytes) const { std::ofstream(folder_ + "/" + name) << bytes; }

  const std::string folder_ = ::testing::TempDir() + "/curvecast_corpus_test_" + std::to_string(getpid());
  const CorpusOptions options_{.points = 500};
};

TEST_F(CorpusTest, TakesGoodBrokenAndEmptyFiles) {
  using namespace curvecast::testing;
  write("b_torus.off", to_off(torus(16, 8)));
  write("a_broken.OFF", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
  write("below/far.off", to_off(translated(sphere(8, 12), {1e6, 0, 0})));
  write("c_empty.ply", "");
  write("d_points.off", "OFF\n2 0 0\n0 0 0\n1 0 0\n");
  write("e_flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n");
  write("notes.txt", "no mesh");
  std::vector<std::string> seen;
  const auto entries = run_corpus(folder_, options_, {}, [&](const CorpusEntry& entry) { seen.push_back(entry.name); });
  ASSERT_TRUE(entries.ok()) << entries.status();
  EXPECT_THAT(seen, ElementsAre("a_broken.OFF", "b_torus.off", "below/far.off", "c_empty.ply", "d_points.off", "e_flat.off"));
  std::vector<Verdict> verdicts;
  for (const CorpusEntry& entry : *entries) verdicts.push_back(entry.verdict);
  EXPECT_THAT(verdicts, ElementsAre(Verdict::kRefused, Verdict::kPassed, Verdict::kPassed, Verdict::kRefused, Verdict::kNothing,
                                    Verdict::kNothing));
  EXPECT_THAT((*entries)[0].message, HasSubstr("a_broken.OFF"));
  EXPECT_THAT((*entries)[5].message, HasSubstr("no face with an area"));
  const CorpusEntry& torus = (*entries)[1];
  EXPECT_EQ(torus.message, "");
  EXPECT_EQ(torus.report.mesh.genus, 1u);
  EXPECT_EQ(torus.report.flipped_triangles, 0u);
  EXPECT_LE(torus.area_error, 1e-9);
  EXPECT_GT(torus.sample_distance, 0);  // floats
  EXPECT_LT(torus.sample_distance, 1e-6);
  EXPECT_FALSE(corpus_passed(*entries));

  const Json json = corpus_json(*entries);
  EXPECT_EQ(json["name"], "corpus");
  EXPECT_EQ(json["files"].size(), 6u);
  EXPECT_EQ(json["results"][1]["case"], "passed");
  EXPECT_EQ(json["results"][1]["value"], 2);
  const std::string csv = corpus_csv(*entries), markdown = corpus_markdown(*entries);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  EXPECT_THAT(csv, HasSubstr("b_torus.off,passed,off,128,256,1,1,0,"));
  EXPECT_THAT(markdown, HasSubstr("| e_flat.off | nothing to sample |"));
}

TEST_F(CorpusTest, PassesWhenAllThatHasAreaComesThrough) {
  write("a.off", curvecast::testing::to_off(curvecast::testing::cube()));
  write("b.off", "OFF\n2 0 0\n0 0 0\n1 0 0\n");
  const auto entries = run_corpus(folder_, options_, {});
  ASSERT_TRUE(entries.ok());
  EXPECT_TRUE(corpus_passed(*entries));
}

TEST_F(CorpusTest, StopsWhenCancelledAndNamesAMissingFolder) {
  write("a.off", curvecast::testing::to_off(curvecast::testing::cube()));
  const std::atomic<bool> cancel = true;
  EXPECT_EQ(run_corpus(folder_, options_, {.cancel = &cancel}).status().code(), absl::StatusCode::kCancelled);
  const auto missing = run_corpus("/nonexistent/folder", options_, {});
  EXPECT_EQ(missing.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.status().message()), HasSubstr("/nonexistent/folder"));
}

TEST(CorpusTable, QuotesWhatNeedsIt) {
  CorpusEntry entry{.name = "a,\"b\".off"};
  entry.message = "x|y";
  EXPECT_THAT(corpus_csv({entry}), HasSubstr("\"a,\"\"b\"\".off\",refused"));
  EXPECT_THAT(corpus_markdown({entry}), HasSubstr("x\\|y"));
}

}  // namespace
}  // namespace curvecast::cli::bench
