#include "client/lib/companion_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace curvecast::client {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// A mesh's folder with a secret beside it.
class CompanionFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(::testing::TempDir()) / ("companion_files_test_" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_ / "mesh/textures");
    fs::create_directories(root_ / "mesh/.hidden");
    fs::create_directories(root_ / "meshes");
    put("mesh/a.obj", "mesh");
    put("mesh/a.mtl", "library");
    put("mesh/textures/b.PNG", "picture");
    put("mesh/two words.jpg", "photograph");
    put("mesh/notes.txt", "private");
    put("mesh/.hidden/key.png", "private");
    put("mesh/.key.png", "private");
    put("mesh/empty.png", "");
    put("secret.png", "private");
    put("meshes/secret.png", "private");
  }
  void TearDown() override { fs::remove_all(root_); }

  void put(const std::string& name, const std::string& bytes) const { std::ofstream(root_ / name) << bytes; }
  absl::StatusOr<InputFile> open(std::string_view name) const { return open_companion((root_ / "mesh/a.obj").string(), name); }
  std::string content_of(std::string_view name) const {
    const absl::StatusOr<InputFile> file = open(name);
    if (!file.ok()) return file.status().ToString();
    std::string bytes(file->size(), '\0');
    EXPECT_TRUE(file->read_at(0, bytes).ok());
    return bytes;
  }

  fs::path root_;
};

TEST_F(CompanionFiles, OpensWhatLiesInTheFolder) {
  EXPECT_EQ(content_of("a.mtl"), "library");
  EXPECT_EQ(content_of("textures/b.PNG"), "picture");
  EXPECT_EQ(content_of("two words.jpg"), "photograph");
  EXPECT_TRUE(absl::IsNotFound(open("missing.png").status()));
  EXPECT_TRUE(absl::IsNotFound(open("a.mtl/x.png").status()));
}

TEST_F(CompanionFiles, RefusesEveryWayOut) {
  const std::string absolute = (root_ / "mesh/a.mtl").string();
  const std::string with_zero("a.mtl\0.png", 10);
  for (const std::string& name :
       {std::string(), std::string("/"), std::string("."), std::string(".."), std::string("../secret.png"),
        std::string("../mesh/a.mtl"), std::string("textures/../a.mtl"), std::string("textures/../../secret.png"),
        std::string("./../secret.png"), std::string("../meshes/secret.png"), std::string("/etc/passwd"), absolute,
        std::string("//etc/passwd.png"), std::string("textures/"), with_zero}) {
    EXPECT_TRUE(absl::IsInvalidArgument(open(name).status())) << name << ": " << open(name).status();
  }
}

TEST_F(CompanionFiles, RefusesWhatIsNoPartOfAMesh) {
  for (const char* name : {"notes.txt", "a.obj", ".key.png", ".hidden/key.png", ".mtl", "textures/.png"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(open(name).status())) << name;
  }
  EXPECT_THAT(std::string(open("notes.txt").status().message()), HasSubstr("notes.txt"));
}

TEST_F(CompanionFiles, LinksMayNotLeadOut) {
  fs::create_symlink("a.mtl", root_ / "mesh/inside.mtl");
  fs::create_symlink("../secret.png", root_ / "mesh/outside.png");
  fs::create_symlink(root_ / "secret.png", root_ / "mesh/absolute.png");
  fs::create_directory_symlink(root_, root_ / "mesh/up");
  fs::create_directory_symlink("../meshes", root_ / "mesh/sibling");  // its name begins like the mesh's folder
  fs::create_symlink("loop.png", root_ / "mesh/loop.png");
  EXPECT_EQ(content_of("inside.mtl"), "library");
  for (const char* name : {"outside.png", "absolute.png", "up/secret.png", "sibling/secret.png"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(open(name).status())) << name;
    EXPECT_THAT(std::string(open(name).status().message()), HasSubstr("leads out")) << name;
  }
  EXPECT_EQ(content_of("up/mesh/a.mtl"), "library") << "out and back again is in";
  EXPECT_FALSE(open("loop.png").ok());
}

TEST_F(CompanionFiles, TakesRegularFilesOnly) {
  fs::create_directories(root_ / "mesh/folder.png");
  ASSERT_EQ(mkfifo((root_ / "mesh/pipe.png").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", root_ / "mesh/zero.png");
  for (const char* name : {"folder.png", "pipe.png", "zero.png", "empty.png"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(open(name).status())) << name;
  }
}

TEST_F(CompanionFiles, AMeshInTheWorkingFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(root_ / "mesh");
  EXPECT_TRUE(open_companion("a.obj", "textures/b.PNG").ok());
  EXPECT_FALSE(open_companion("a.obj", "../secret.png").ok());
  fs::current_path(before);
}

TEST(MayHaveCompanions, TellsByTheEnding) {
  for (const char* name : {"a.obj", "b/A.OBJ", "a.gltf", "a.glb", "a.ply"}) EXPECT_TRUE(may_have_companions(name)) << name;
  for (const char* name : {"a.off", "a.stl", "obj", ".obj", "a.obj/b.off"}) EXPECT_FALSE(may_have_companions(name)) << name;
}

}  // namespace
}  // namespace curvecast::client
