#include "client/cli/sample/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace curvecast::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

absl::StatusOr<std::vector<ManifestEntry>> parse(const std::string& text) {
  std::istringstream in(text);
  return parse_manifest(in);
}

void expect_refused(const std::string& text, const std::string& message) {
  const auto entries = parse(text);
  EXPECT_TRUE(absl::IsInvalidArgument(entries.status())) << text;
  EXPECT_THAT(std::string(entries.status().message()), HasSubstr(message));
}

TEST(Manifest, ReadsPathsLineByLine) {
  const auto entries = parse(
      "\xef\xbb\xbf"
      "a.ply\n\n  # a comment\n  b c/d.obj  \r\n/data/e.off");
  ASSERT_TRUE(entries.ok()) << entries.status();
  ASSERT_EQ(entries->size(), 3U);
  EXPECT_EQ((*entries)[0].mesh, "a.ply");
  EXPECT_EQ((*entries)[0].name, "a");
  EXPECT_EQ((*entries)[0].line, 1U);
  EXPECT_THAT((*entries)[0].arguments, IsEmpty());
  EXPECT_EQ((*entries)[1].mesh, "b c/d.obj");
  EXPECT_EQ((*entries)[1].name, "b c/d");
  EXPECT_EQ((*entries)[1].line, 4U);
  EXPECT_EQ((*entries)[2].mesh, "/data/e.off");
  EXPECT_EQ((*entries)[2].name, "data/e") << "beneath the folder of outputs";
}

TEST(Manifest, ReadsObjectsWithOptions) {
  const auto entries = parse(
      "plain.ply\n"
      R"({"mesh": "a/./b.tar.ply", "points": 20000, "density": ["curvature", "view:s0=0.1"], "pixel_error": 1.5, "first-answer": true})"
      "\n"
      R"({"name": "x/y", "mesh": "../z.ply"})");
  ASSERT_TRUE(entries.ok()) << entries.status();
  ASSERT_EQ(entries->size(), 3U);
  EXPECT_EQ((*entries)[1].name, "a/b.tar");
  EXPECT_THAT((*entries)[1].arguments,
              ::testing::UnorderedElementsAre("--points=20000", "--density=curvature", "--density=view:s0=0.1",
                                              "--pixel-error=1.5", "--first-answer=true"));
  EXPECT_EQ((*entries)[2].mesh, "../z.ply");
  EXPECT_EQ((*entries)[2].name, "x/y");
}

TEST(Manifest, SaysWhatIsWrongAndWhere) {
  expect_refused("", "names no meshes");
  expect_refused("# nothing\n", "names no meshes");
  expect_refused("a.ply\n{\"mesh\": \"b.ply\"", "line 2: it begins as a JSON object");
  expect_refused("{\"name\": \"b\"}", "line 1: it names no 'mesh'");
  expect_refused("{\"mesh\": 5}", "'mesh' is no string");
  expect_refused("{\"mesh\": \"a.ply\", \"points\": null}", "'points' is neither");
  expect_refused("{\"mesh\": \"a.ply\", \"points\": {\"n\": 5}}", "'points' is neither");
  expect_refused("{\"mesh\": \"a.ply\", \"density\": [[\"view\"]]}", "'density' has arrays");
  expect_refused("../a.ply", "line 1: ../a.ply: '../a' is no name");
  expect_refused("..", "is no name");
  expect_refused("/", "is no name");
}

TEST(Manifest, NamesStayWithinTheFolder) {
  for (const char* name : {"a", "a/b", "a.b/c.d", "a b", "..a"}) EXPECT_TRUE(check_output_name(name).ok()) << name;
  for (const char* name : {"", ".", "..", "../a", "a/..", "a/../b", "/a", "a/", "a//b", "./a"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(check_output_name(name))) << name;
  }
}

TEST(Manifest, ErrorsNameTheFile) {
  const std::string missing = ::testing::TempDir() + "/curvecast_no_manifest";
  EXPECT_TRUE(absl::IsNotFound(read_manifest(missing).status()));
  EXPECT_THAT(std::string(read_manifest(missing).status().message()), HasSubstr(missing + ": cannot be opened"));
  EXPECT_THAT(std::string(read_manifest(::testing::TempDir()).status().message()), HasSubstr("is a directory"));
  const std::string path = ::testing::TempDir() + "/curvecast_manifest_" + std::to_string(getpid());
  std::ofstream(path) << "a.ply\n{}\n";
  EXPECT_THAT(std::string(read_manifest(path).status().message()), HasSubstr(path + ": line 2: "));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace curvecast::cli
