#include "client/cli/sample/batch_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "client/cli/sample/batch_record.h"

namespace curvecast::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

BatchSettings with_points(std::uint64_t points) {
  BatchSettings settings;
  settings.sampling.sample.points = points;
  return settings;
}

absl::StatusOr<std::vector<PlannedMesh>> plan(const std::string& list, BatchSettings usual = with_points(100),
                                              const std::string& out = "out") {
  std::istringstream in(list);
  auto entries = parse_manifest(in);
  EXPECT_TRUE(entries.ok()) << entries.status();
  EntryOptions options(std::move(usual));
  return plan_batch(*std::move(entries), "meshes", out, options);
}

void expect_refused(const absl::Status& status, const std::string& message) {
  EXPECT_TRUE(absl::IsInvalidArgument(status));
  EXPECT_THAT(std::string(status.message()), HasSubstr(message));
}

TEST(EntryOptions, WhatAnEntrySaysIsForItAlone) {
  BatchSettings usual = with_points(100);
  usual.sampling.sample.density = {"curvature"};
  usual.seed = 3;
  EntryOptions options(usual);
  const auto own = options.of({"--points=7", "--density=view", "--density=screen", "--seed=9", "--format=drc", "--max-points=500",
                               "--omega=12", "--first-answer=true", "--attributes=rank,surface"});
  ASSERT_TRUE(own.ok()) << own.status();
  EXPECT_EQ(own->sampling.sample.points, 7U);
  EXPECT_THAT(own->sampling.sample.density, ElementsAre("view", "screen"));
  EXPECT_EQ(own->seed, 9U);
  EXPECT_EQ(own->format, "drc");
  EXPECT_EQ(own->sampling.max_points, 500U);
  EXPECT_EQ(own->sampling.session.omega, 12);
  EXPECT_TRUE(own->sampling.first_answer);
  EXPECT_THAT(own->sampling.attributes, ElementsAre("rank", "surface"));
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{{}, {"--sampler=progressive"}}) {
    const auto next = options.of(arguments);
    ASSERT_TRUE(next.ok()) << next.status();
    EXPECT_EQ(next->sampling.sample.points, 100U);
    EXPECT_THAT(next->sampling.sample.density, ElementsAre("curvature"));
    EXPECT_EQ(next->seed, 3U);
    EXPECT_EQ(next->format, "ply");
    EXPECT_FALSE(next->sampling.first_answer);
    EXPECT_THAT(next->sampling.attributes, IsEmpty());
  }
}

TEST(EntryOptions, OfThreeBudgetsTheEntrysOwnCounts) {
  EntryOptions options(with_points(100));
  const auto own = options.of({"--pixel-error=2"});
  ASSERT_TRUE(own.ok()) << own.status();
  EXPECT_EQ(own->sampling.sample.points, 0U);
  EXPECT_EQ(own->sampling.sample.pixel_error, 2);
  EXPECT_FALSE(options.of({"--pixel-error=2", "--points=5"}).ok());
  EntryOptions none{BatchSettings{}};
  expect_refused(none.of({}).status(), "how many points?");
  EXPECT_TRUE(none.of({"--max-bytes=5000"}).ok());
  EXPECT_TRUE(none.of({"--format=none"}).ok());
}

TEST(EntryOptions, AreCheckedAsTheCommandsAre) {
  EntryOptions options(with_points(100));
  expect_refused(options.of({"--pionts=5"}).status(), "there is no option 'pionts'");
  expect_refused(options.of({"--help=true"}).status(), "there is no option 'help'");
  expect_refused(options.of({"--points=0"}).status(), "points");
  expect_refused(options.of({"--points=1.5"}).status(), "points");
  expect_refused(options.of({"--density=blob"}).status(), "there are: uniform");
  expect_refused(options.of({"--format=obj"}).status(), "ply, xyz, pcd, drc, npy, npz, glb, spz, las, none");
  expect_refused(options.of({"--format=pcd", "--splats=true"}).status(), "splats are written to .ply, .glb and .spz");
  expect_refused(options.of({"--glb=bytes"}).status(), "floats, quantised, meshopt");
  expect_refused(options.of({"--camera=eye=1"}).status(), "eye takes 3 numbers");
  EXPECT_TRUE(options.of({}).ok()) << "what was wrong leaves nothing behind";
}

TEST(BatchPlan, SaysWhatGoesWhere) {
  const auto planned =
      plan("a/b.ply\n{\"mesh\": \"/c.off\", \"format\": \"none\"}\n{\"mesh\": \"d.off\", \"name\": \"e\", \"format\": \"xyz\"}");
  ASSERT_TRUE(planned.ok()) << planned.status();
  ASSERT_EQ(planned->size(), 3U);
  EXPECT_EQ((*planned)[0].path, "meshes/a/b.ply");
  EXPECT_EQ((*planned)[0].output, "a/b.ply");
  EXPECT_EQ((*planned)[0].record, "a/b.ply.json");
  EXPECT_EQ((*planned)[1].path, "/c.off");
  EXPECT_EQ((*planned)[1].output, "");
  EXPECT_EQ((*planned)[1].record, "c.session.json");
  EXPECT_EQ((*planned)[2].output, "e.xyz");
}

TEST(BatchPlan, RefusesWhatWouldBeLost) {
  expect_refused(plan("a.ply\nb.ply\na.off").status(), "line 3: a.off: its output a.ply is that of line 1 too");
  EXPECT_TRUE(plan("a.ply\n{\"mesh\": \"a.ply\", \"format\": \"drc\"}").ok());
  expect_refused(
      plan("b.off\na.off\n{\"mesh\": \"c.off\", \"name\": \"a\", \"format\": \"none\"}\nx/a.ply", with_points(5), "meshes/x")
          .status(),
      "line 2: a.off: its output a.ply would replace the mesh of line 4");
  expect_refused(plan("a.ply\n{\"mesh\": \"b.ply\", \"points\": 0}").status(), "line 2: b.ply: ");
}

TEST(BatchRecord, SettingsTellWhatPointsDependOn) {
  EntryOptions options(with_points(100));
  const auto json_of = [&](const std::vector<std::string>& arguments) {
    const auto settings = options.of(arguments);
    EXPECT_TRUE(settings.ok()) << settings.status();
    const auto json = settings_json(*settings);
    EXPECT_TRUE(json.ok()) << json.status();
    return *json;
  };
  const Json usual = json_of({});
  EXPECT_EQ(Json::parse(usual.dump()), usual) << "as it is read from a record";
  for (const char* argument : {"--points=101",
                               "--pixel-error=3",
                               "--max-bytes=9000",
                               "--density=curvature",
                               "--sampler=progressive",
                               "--sequence=golden",
                               "--camera=fov=20",
                               "--base-density=curvature",
                               "--omega=11",
                               "--crease=20",
                               "--chart-faces=5000",
                               "--parameteriser=cgal",
                               "--mapper=id-buffer",
                               "--area=voronoi",
                               "--attributes=surface",
                               "--first-answer=true",
                               "--position-bits=12",
                               "--normal-bits=9",
                               "--max-points=70000",
                               "--format=drc",
                               "--format=none",
                               "--splats=true",
                               "--glb=meshopt",
                               "--seed=1"}) {
    EXPECT_NE(json_of({argument}), usual) << argument;
  }
  EXPECT_EQ(json_of({"--points=100"}), usual);
}

TEST(BatchRecord, FilesInOrderOfRankAskForRanks) {
  EntryOptions options(with_points(100));
  const auto attributes_of = [&](const std::vector<std::string>& arguments) {
    const Json json = *settings_json(*options.of(arguments));
    return json["sample"].value("attributes", Json::array());
  };
  const Json rank = {"POINT_ATTRIBUTE_RANK"};
  for (const char* format : {"npy", "npz", "glb", "spz", "las"}) {
    EXPECT_EQ(attributes_of({absl::StrCat("--format=", format), "--sampler=progressive"}), rank) << format;
    EXPECT_EQ(attributes_of({absl::StrCat("--format=", format), "--sampler=progressive", "--attributes=rank"}), rank) << "once";
    EXPECT_TRUE(attributes_of({absl::StrCat("--format=", format)}).empty()) << "the equalised sampler has none";
  }
  EXPECT_EQ(attributes_of({"--splats=true", "--sampler=progressive"}), rank);
  EXPECT_TRUE(attributes_of({"--format=ply", "--sampler=progressive"}).empty());
}

}  // namespace
}  // namespace curvecast::cli
