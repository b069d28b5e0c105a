// The benchmark of the paper, quickly, on a small mesh.
#include "client/bench/paper/paper_bench.h"

#include <absl/strings/str_format.h>
#include <gmock/gmock.h>

#include <atomic>
#include <fstream>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "client/bench/paper/paper_json.h"
#include "client/bench/paper/paper_page.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::cli::bench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string& torus_off() {
  static const std::string kOff = curvecast::testing::to_off(curvecast::testing::torus(40, 24));
  return kOff;
}

/// Meshes of these names, all the same.
absl::StatusOr<PaperFindings> run(const std::vector<std::string>& names, const CommonOptions& common = {},
                                  const ExecutionContext& context = {}, const std::string& bytes = torus_off()) {
  const curvecast::testing::TemporaryFolder folder;
  std::vector<PaperInput> inputs;
  for (const std::string& name : names) {
    inputs.push_back({folder / name, {name, bytes}});
    std::ofstream(inputs.back().path) << bytes;
  }
  return bench_paper(inputs, {.quick = true, .machine = "a <machine>"}, common, context, {});
}

/// One under a name that the paper knows, and one under a name that it does not, once for several tests.
const PaperFindings& two_meshes() {
  static const absl::StatusOr<PaperFindings> kFindings = run({"my-Squirrel.off", "torus.off"}, {.threads = 2}, {.threads = 2});
  return *kFindings;  // throws where it is an error
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// What may differ from run to run.
void erase_seconds(nlohmann::ordered_json& json) {
  for (auto& mesh : json["table_1"]["meshes"]) {
    mesh["seconds"].erase("defaults");
    mesh["seconds"].erase("literal");
  }
  for (auto& claim : json["claims"]) {
    if (claim["claim"].get<std::string>().find("seconds") == std::string::npos) continue;
    claim.erase("ours");
    claim.erase("holds");
  }
}

TEST(PaperBench, ThePageHoldsAllThatThePaperHasAndNeedsNothingElse) {
  const PaperFindings& findings = two_meshes();
  const std::string page = paper_page(findings);
  for (const char* const part : {"http:", "https:", "href=", "url(", "@import", "<script", "<link"}) {
    EXPECT_THAT(page, Not(HasSubstr(part)));
  }
  EXPECT_EQ(count(page, "src="), count(page, "src=\"data:image/png;base64,"));
  EXPECT_EQ(count(page, "src="), findings.pictures.size());
  EXPECT_THAT(page, HasSubstr("a &lt;machine&gt;"));
  EXPECT_THAT(page, HasSubstr("Table 1"));
  EXPECT_THAT(page, HasSubstr("Table 2"));
  EXPECT_EQ(count(page, "<svg"), 2u);
  for (int figure = 1; figure <= 9; ++figure) EXPECT_EQ(count(page, absl::StrFormat("id=\"figure-%d\"", figure)), 1u) << figure;
  std::vector<std::string> figures;
  for (const Picture& picture : findings.pictures) {
    figures.push_back(picture.figure);
    EXPECT_EQ(picture.png.substr(1, 3), "PNG");
  }
  // 6 kinds of points, three angles, two meshes with three samplings and two remeshes each.
  EXPECT_THAT(figures, ::testing::ElementsAre("1", "1", "2 a", "2 b", "2 c", "2 d", "2 e", "2 f", "3", "3", "3", "3", "3", "3",
                                              "6", "6", "6", "6", "6", "6", "7", "7", "8", "8", "8", "9", "9", "9", "9"));
  // The paper's numbers stand beside the mesh that is named like one of its own, and beside no other.
  EXPECT_EQ(count(page, "Squirrel: paper"), 2u);
  EXPECT_EQ(count(page, "-0.74"), 2u);  // table, plot
  EXPECT_THAT(page, HasSubstr("<td>0.018</td>"));
}

TEST(PaperBench, TheJsonHasTheNumbersOfThePage) {
  const std::string page = paper_page(two_meshes());
  const nlohmann::ordered_json json = paper_json(two_meshes());
  const auto& mesh = json["table_1"]["meshes"][0];
  EXPECT_EQ(mesh["faces"], 1920);
  EXPECT_EQ(mesh["paper"]["name"], "Squirrel");
  EXPECT_EQ(mesh["seconds"]["paper"]["t_p"], 1.3);
  for (const char* const way : {"defaults", "literal"}) {
    for (const char* const stage : {"t_p", "t_c", "t_m", "t_s", "t"}) {
      const double ours = mesh["seconds"][way][stage], papers = mesh["seconds"]["paper"][stage];
      EXPECT_THAT(page, HasSubstr(absl::StrFormat("%.3g (&times;%.3g)", ours, papers / ours))) << way << stage;
    }
  }
  const auto& gradients = json["table_2"][0]["gradients"];
  EXPECT_EQ(gradients["paper"], -0.74);
  for (const char* const name : {"defaults", "literal", "progressive", "random", "random in each triangle"}) {
    ASSERT_TRUE(gradients.contains(name)) << name;
    EXPECT_THAT(page, HasSubstr(absl::StrFormat("<td>%.3f</td><td>%.3f</td>", gradients[name]["rms"].get<double>(),
                                                gradients[name]["max"].get<double>())));
  }
  EXPECT_NEAR(gradients["random"]["rms"].get<double>(), -0.5, 0.1);
  EXPECT_LT(gradients["defaults"]["rms"].get<double>(), -0.65);
  for (const auto& error : json["table_2"][0]["hausdorff_percent_of_diagonal"]) {
    if (error["way"] == "paper") continue;
    EXPECT_NEAR(error["triangles"].get<double>() / 1920, error["percent"].get<double>() / 100, 0.01);
    EXPECT_LE(error["mean"], error["rms"]);
    EXPECT_LE(error["rms"], error["max"]);
    EXPECT_THAT(page, HasSubstr(absl::StrFormat("%.2g / %.2g / %.2g", error["mean"].get<double>(), error["rms"].get<double>(),
                                                error["max"].get<double>())));
  }
  for (const auto& set : json["figure_6"]["sets"]) {
    EXPECT_THAT(page, HasSubstr(absl::StrFormat("<td>%.3g</td><td>%.1f %%</td>", set["star_discrepancy"].get<double>(),
                                                100 * set["covered_share"].get<double>())));
  }
  EXPECT_EQ(json["figure_5"][0]["lines"][0]["rms"].size(), json["figure_5"][0]["points"].size());
}

TEST(PaperBench, IsTheSameForAnyNumberOfThreadsButForSeconds) {
  const auto again = run({"my-Squirrel.off", "torus.off"}, {.threads = 1}, {.threads = 1});
  ASSERT_TRUE(again.ok()) << again.status();
  const PaperFindings &one = two_meshes(), &two = *again;
  nlohmann::ordered_json first = paper_json(one), second = paper_json(two);
  erase_seconds(first);
  erase_seconds(second);
  EXPECT_EQ(first.dump(), second.dump());
  for (std::size_t i = 0; i < one.pictures.size(); ++i) {
    EXPECT_TRUE(one.pictures[i].png == two.pictures[i].png) << one.pictures[i].caption;
  }
}

TEST(PaperBench, WithoutAMeshShowsWhatNeedsNone) {
  const auto findings = run({});
  ASSERT_TRUE(findings.ok()) << findings.status();
  EXPECT_EQ(findings->pictures.size(), 10u);
  ASSERT_EQ(findings->squares.size(), 6u);
  // Random points leave the largest holes; the progressive sampler's the smallest of ours.
  const auto covered = [&](std::size_t i) { return findings->squares[i].covered; };
  EXPECT_LT(covered(0), 0.91);
  EXPECT_GT(covered(4), covered(0) + 0.02);
  EXPECT_GT(covered(5), covered(4) + 0.02);
  const std::string page = paper_page(*findings);
  EXPECT_THAT(page, HasSubstr("id=\"figure-9\""));
  EXPECT_THAT(page, Not(HasSubstr("Table 1")));
}

TEST(PaperBench, StopsWhenCancelledAndSaysWhatIsWrongWithAMesh) {
  const std::atomic<bool> cancel = true;
  ExecutionContext context;
  context.cancel = &cancel;
  EXPECT_TRUE(absl::IsCancelled(run({"torus.off"}, {}, context).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(run({"bad.off"}, {}, {}, "OFF\n1 1 0\n0 0 0\n").status()));
}

TEST(PaperPage, HasARowForAWayThatOnlyRemeshes) {
  PaperFindings findings;
  MeshFindings& mesh = findings.meshes.emplace_back();
  mesh.file = "a&b.off";
  mesh.ring_sizes = {2, 3};
  mesh.rings = {{"defaults", 1, {{0.5, 0.4}, {0.5, 0.4}, -0.7, -0.6}}, {"literal", 1, {{0.5, 0.4}, {0.5, 0.4}, -0.7, -0.6}}};
  mesh.remeshes = {{"defaults", 75, 10, 0.1, 0.2, 0.3}, {"another", 50, 10, 0.4, 0.5, 0.6}};
  const std::string page = paper_page(findings);
  EXPECT_THAT(page, HasSubstr("<td>a&amp;b.off: defaults</td><td>-0.700</td><td>-0.600</td><td></td><td>0.1 / 0.2 / 0.3</td>"));
  EXPECT_THAT(page, HasSubstr("<td>a&amp;b.off: another</td><td></td><td></td><td></td><td></td><td>0.4 / 0.5 / 0.6</td>"));
}

TEST(PaperMesh, IsFoundByItsFilesName) {
  EXPECT_STREQ(paper_mesh("chinese-lion.obj")->name, "Lion");
  EXPECT_STREQ(paper_mesh("IGEA.ply")->name, "Igea");
  EXPECT_STREQ(paper_mesh("julius-caesar.off")->name, "J Caesar");
  EXPECT_EQ(paper_mesh("bunny.obj"), nullptr);
}

TEST(PaperClaims, SayWhatDoesNotHold) {
  PaperFindings findings;
  MeshFindings& mesh = findings.meshes.emplace_back();
  mesh.file = "igea.ply";
  mesh.paper = paper_mesh(mesh.file);
  mesh.seconds = {StageTimes{0.3, 0.1, 0.1, 0.001, 0.6}, StageTimes{71, 0.1, 0.1, 0.001, 71.5}};
  mesh.rings = {
      {"defaults", 1, {{}, {}, -0.74, -0.7}}, {"literal", 1, {{}, {}, -0.72, -0.7}}, {"random", 0, {{}, {}, -0.53, -0.5}}};
  EXPECT_EQ(claims_of(findings).size(), 13u);
  std::vector<std::string> broken;
  for (const Claim& claim : claims_of(findings)) {
    if (!claim.holds) broken.push_back(claim.text);
  }
  EXPECT_THAT(broken, ::testing::ElementsAre(HasSubstr("random points"), HasSubstr("literal: parametrisation"),
                                             HasSubstr("literal: the discrepancy")));
  findings.quick = true;
  EXPECT_EQ(claims_of(findings).size(), 10u);
}

}  // namespace
}  // namespace curvecast::cli::bench
