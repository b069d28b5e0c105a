#include "server/session/import_mesh.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;

class ImportMesh : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "inner");
    write(folder_ / "ball.off", "a ball");
    write(folder_ / "inner" / "cube.off", "a cube");
    write(fs::path(root_.path()) / "secret", "nobody's business");
    fs::create_symlink(fs::path(root_.path()) / "secret", folder_ / "link");
    fs::create_directory_symlink(root_.path(), folder_ / "up");
    fs::create_symlink(folder_ / "ball.off", folder_ / "alias.off");
  }
  static void write(const fs::path& path, const std::string& content) { std::ofstream(path, std::ios::binary) << content; }
  absl::StatusCode code_of(const std::string& path) {
    return import_mesh(store_, {}, folder_.string(), path, {}).status().code();
  }

  testing::TemporaryFolder root_;
  fs::path folder_ = fs::path(root_.path()) / "meshes";
  MeshStore store_{{1 << 20, 100'000}};
};

TEST_F(ImportMesh, TakesFilesOfTheFolder) {
  for (const auto& [path, content] : {std::pair("ball.off", "a ball"), std::pair("inner/cube.off", "a cube"),
                                      std::pair("inner/../ball.off", "a ball"), std::pair("alias.off", "a ball")}) {
    const auto mesh = import_mesh(store_, {}, folder_.string(), path, {});
    ASSERT_TRUE(mesh.ok()) << path << ": " << mesh.status();
    EXPECT_EQ(std::string((*mesh)->bytes().begin(), (*mesh)->bytes().end()), content);
    EXPECT_TRUE(store_.find((*mesh)->id).ok());
  }
  EXPECT_EQ(store_.usage().meshes, 2u);
}

TEST_F(ImportMesh, NeverLeavesTheFolder) {
  for (const char* path : {"../secret", "inner/../../secret", "link", "up/secret", "up/meshes/../secret", "/etc/passwd", "..",
                           "../nothing", "up/nothing"}) {
    EXPECT_EQ(code_of(path), absl::StatusCode::kPermissionDenied) << path;
  }
  EXPECT_EQ(code_of(fs::absolute(folder_ / "ball.off").string()), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(code_of(std::string("ball.off\0x", 10)), absl::StatusCode::kPermissionDenied);
  EXPECT_TRUE(absl::IsPermissionDenied(import_mesh(store_, {}, "", "ball.off", {}).status()));
}

TEST_F(ImportMesh, SaysWhatIsMissingOrTooLarge) {
  EXPECT_EQ(code_of("nothing.off"), absl::StatusCode::kNotFound);
  EXPECT_EQ(code_of("inner"), absl::StatusCode::kNotFound);
  EXPECT_EQ(code_of(""), absl::StatusCode::kNotFound);
  write(folder_ / "large.off", std::string(200'000, 'x'));
  EXPECT_EQ(code_of("large.off"), absl::StatusCode::kResourceExhausted);
  write(folder_ / "empty.off", "");
  EXPECT_EQ(code_of("empty.off"), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(absl::IsNotFound(import_mesh(store_, {}, (folder_ / "gone").string(), "ball.off", {}).status()));
}

}  // namespace
}  // namespace curvecast::server
