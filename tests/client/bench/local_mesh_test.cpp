#include "client/bench/local_mesh.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace curvecast::cli::bench {
namespace {

TEST(LocalMesh, ReadsTheMeshAndWhatLiesBesideIt) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "local_mesh";
  std::filesystem::create_directories(folder / "inner");
  std::ofstream(folder / "secret.mtl") << "newmtl outside\n";
  std::ofstream(folder / "inner/a.obj") << "mtllib a.mtl\n";
  std::ofstream(folder / "inner/a.mtl") << "newmtl a\n";
  absl::StatusOr<LocalMesh> mesh = LocalMesh::read(folder / "inner/a.obj");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  const MeshFile file = mesh->file("a.obj");
  EXPECT_EQ(std::string(file.bytes.begin(), file.bytes.end()), "mtllib a.mtl\n");
  const auto material = file.companion("a.mtl");
  ASSERT_TRUE(material.has_value());
  EXPECT_EQ(std::string(material->begin(), material->end()), "newmtl a\n");
  EXPECT_FALSE(file.companion("b.mtl").has_value());
  EXPECT_FALSE(file.companion("../secret.mtl").has_value());
  EXPECT_FALSE(LocalMesh::read(folder / "missing.obj").ok());
}

}  // namespace
}  // namespace curvecast::cli::bench
