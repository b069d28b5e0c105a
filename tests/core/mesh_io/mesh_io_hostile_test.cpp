// Good files, cut and damaged anywhere: always an error that says where or a valid mesh, never a crash. What is made to hurt is
// in tests/support/hostile_files.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/mesh_io/mesh_io.h"
#include "tests/core/mesh_io/mesh_writers.h"
#include "tests/core/mesh_io/test_companions.h"
#include "tests/support/mesh_promises.h"
#include "tests/support/mesh_samples.h"

namespace curvecast {
namespace {

using testing::MeshSample;
using ::testing::StartsWith;

absl::StatusOr<PolygonSoup> read(const std::string& name, const std::string& bytes, const Companions& companions = {}) {
  const std::vector<char> exact(bytes.begin(), bytes.end());  // no terminator behind: reading past the end is found out
  MeshFile file = mesh_file(name, bytes, companions);
  file.bytes = exact;
  return read_mesh(file);
}

// What read_mesh promises, for any bytes at all.
void expect_promise(const std::string& name, const std::string& bytes, const Companions& companions) {
  const absl::StatusOr<PolygonSoup> soup = read(name, bytes, companions);
  if (!soup.ok()) {
    EXPECT_EQ(soup.status().code(), absl::StatusCode::kInvalidArgument) << soup.status();
    EXPECT_THAT(std::string(soup.status().message()), StartsWith(name + ": "));
    return;
  }
  ASSERT_EQ(testing::broken_promise(*soup), "");
  const std::size_t memory = soup->positions.capacity() * sizeof(Vec3d) +
                             (soup->indices.capacity() + soup->polygon_begin.capacity()) * sizeof(std::uint32_t);
  EXPECT_LE(memory, 20 * bytes.size() + 1'000);
}

TEST(MeshIoHostile, EveryPrefixIsAnErrorOrAValidSoup) {
  for (const MeshSample& sample : testing::mesh_samples()) {
    const absl::StatusOr<PolygonSoup> whole = read(sample.name, sample.bytes, sample.companions);
    ASSERT_TRUE(whole.ok()) << whole.status();
    for (std::size_t length = 0; length < sample.bytes.size(); ++length) {
      SCOPED_TRACE(sample.name + " cut to " + std::to_string(length));
      expect_promise(sample.name, sample.bytes.substr(0, length), sample.companions);
    }
  }
}

TEST(MeshIoHostile, TruncatedFilesAreRefused) {
  const FileMesh triangles = tetrahedron();
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    const std::string file = ply_file(triangles, {.format = format});
    for (std::size_t length = 0; length < file.size(); ++length)
      EXPECT_FALSE(read("a.ply", file.substr(0, length)).ok()) << length;
  }
  for (const std::string& file : {binary_stl_file(triangles), binary_stl_file(triangles, "solid")}) {
    for (std::size_t length = 0; length < file.size(); ++length)
      EXPECT_FALSE(read("a.stl", file.substr(0, length)).ok()) << length;
  }
  // Of a text, the last number may lose digits unseen; whole lines may not.
  for (const MeshSample& sample : {MeshSample{"a.ply", ply_file(triangles, {.format = "ascii"})},
                                   MeshSample{"a.off", off_file(triangles)}, MeshSample{"a.stl", text_stl_file(triangles)}}) {
    for (std::size_t at = sample.bytes.find('\n'); at + 1 < sample.bytes.size(); at = sample.bytes.find('\n', at + 1)) {
      EXPECT_FALSE(read(sample.name, sample.bytes.substr(0, at + 1)).ok()) << sample.name << " cut to " << at + 1;
    }
  }
}

TEST(MeshIoHostile, DamagedBytesAreAnErrorOrAValidSoup) {
  std::mt19937 random(7);
  const std::string likely = std::string("\0\xff\x7f\x80 \n\r-+.0919eE/\\#nan", 22);
  for (const MeshSample& sample : testing::mesh_samples()) {
    for (int round = 0; round < 4'000; ++round) {
      std::string bytes = sample.bytes;
      for (std::uint32_t damages = 1 + random() % 3; damages > 0; --damages) {
        const std::size_t at = random() % bytes.size();
        const char byte = random() % 2 != 0 ? likely[random() % likely.size()] : static_cast<char>(random() % 256);
        const std::uint32_t kind = random() % 4;
        if (kind == 0) bytes.erase(at, 1 + random() % 4);
        if (kind == 1) bytes.insert(at, 1, byte);
        if (kind >= 2) bytes[at] = byte;
        if (bytes.empty()) bytes.assign(1, 'x');
      }
      SCOPED_TRACE(sample.name + " round " + std::to_string(round));
      expect_promise(sample.name, bytes, sample.companions);
      if (HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace curvecast
