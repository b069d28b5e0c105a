#include "core/pipeline/memory_estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "core/mesh_io/mesh_io.h"
#include "core/pipeline/pipeline.h"
#include "tests/core/mesh_io/packed_gltf.h"
#include "tests/core/mesh_io/three_mf_writer.h"
#include "tests/support/counted_memory.h"
#include "tests/support/counting_source.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;

struct Shape {
  std::string name;
  PolygonSoup soup;
  std::uint64_t points;
  double omega;
  std::optional<double> crease_degrees;
};

std::vector<Shape> shapes() {
  PolygonSoup crumbs = testing::tetrahedron();
  for (int i = 0; i < 10; ++i) crumbs = testing::merged(crumbs, testing::translated(crumbs, {4.0 * (1 << i), 0, 0}));
  PolygonSoup named = testing::icosphere(5);
  named.attributes.scalars = {{"a", std::vector<float>(named.positions.size(), 1)},
                              {"b", std::vector<float>(named.positions.size(), 2)}};
  return {{"ball", testing::icosphere(7), 1'000, 1},
          {"greater ball of flat faces", testing::icosphere(8), 1'000, 1, 0},
          {"greater ball", testing::icosphere(8), 1'000, 1},
          {"ball with a fine curve", testing::icosphere(5), 200'000, 10},
          {"tetrahedron with a fine curve", testing::tetrahedron(), 200'000, 10},
          {"named values", named, 100'000, 10},
          {"triangles with vertices of their own", testing::unshared(testing::icosphere(7)), 1'000, 1},
          {"slab with many holes", testing::perforated_slab(101, 101), 1'000, 1},
          {"crumbs", crumbs, 10'000, 10},
          {"needles", testing::scaled(testing::open_cylinder(2, 20'000, 0.001), 1), 100'000, 10},
          {"sheet", testing::square(400), 1'000, 1}};
}

TEST(MemoryEstimate, IsMoreThanIsTaken) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const std::string file = testing::to_ply(shape.soup);
    const PreprocessOptions options{.points = shape.points, .omega = shape.omega, .crease_degrees = shape.crease_degrees};
    testing::CountingSource source;
    const testing::CountedMemory memory;
    ASSERT_TRUE(preprocess({"shape.ply", file}, options, {.threads = 2, .memory = &source}).ok());
    const double peak = static_cast<double>(memory.peak()), told = static_cast<double>(source.peak());
    std::printf("%-40s took %6.1f MB, told %6.1f MB, %.2f times\n", shape.name.c_str(), peak / 1e6, told / 1e6, told / peak);
    EXPECT_LE(peak, told);
    EXPECT_GT(4 * peak + (128 << 20), told) << "what is refused would have fit";
    EXPECT_EQ(source.taken(), 0u);
  }
}

TEST(MemoryEstimate, OfInspectionIsMoreThanIsTaken) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const std::string file = testing::to_off(shape.soup);
    testing::CountingSource source;
    const testing::CountedMemory memory;
    ASSERT_TRUE(inspect_mesh({"shape.off", file}, {.threads = 2, .memory = &source}).ok());
    const double peak = static_cast<double>(memory.peak()), told = static_cast<double>(source.peak());
    std::printf("%-40s took %6.1f MB, told %6.1f MB, %.2f times\n", shape.name.c_str(), peak / 1e6, told / 1e6, told / peak);
    EXPECT_LE(peak, told);
    EXPECT_GT(4 * peak + (4 << 20), told) << "what is refused would have fit";
  }
}

/// Positions and faces as writers of files take them.
FileMesh file_mesh(const PolygonSoup& soup) {
  FileMesh mesh;
  for (const Vec3d& p : soup.positions) mesh.vertices.push_back({p.x(), p.y(), p.z()});
  for (std::size_t i = 0; i < soup.indices.size(); i += 3) {
    mesh.faces.push_back(
        {static_cast<int>(soup.indices[i]), static_cast<int>(soup.indices[i + 1]), static_cast<int>(soup.indices[i + 2])});
  }
  return mesh;
}

TEST(MemoryEstimate, OfReadingCompressedFilesIsMoreThanIsTaken) {
  for (const PolygonSoup& soup : {testing::icosphere(7), testing::unshared(testing::icosphere(6)), testing::square(300)}) {
    const FileMesh mesh = file_mesh(soup);
    const std::vector<std::uint8_t> colours(4 * mesh.vertices.size(), 7);
    const std::string model = three_mf_model(three_mf_object(1, mesh), "<item objectid=\"1\"/>");
    const std::pair<const char*, std::string> files[] = {
        {"draco.glb", gltf_with_draco(mesh, draco_bytes(mesh, colours), true).glb()},
        {"draco-in-order.glb", gltf_with_draco(mesh, draco_bytes(mesh, colours, {.sequential = true}), true).glb()},
        {"meshopt.glb", gltf_with_meshopt(mesh).glb()},
        {"mesh.3mf", three_mf_file(model)}};
    for (const auto& [name, file] : files) {
      SCOPED_TRACE(name);
      testing::CountingSource source;
      const ExecutionContext context{.memory = &source};
      const MeshFile mesh_file = {.name = name, .bytes = std::span<const char>(file)};
      const testing::CountedMemory memory;
      MemoryClaim claim(context);
      ASSERT_TRUE(claim_reading(mesh_file, claim).ok());
      const double telling = static_cast<double>(memory.peak());
      ASSERT_TRUE(read_mesh(mesh_file, context).ok());
      const double peak = static_cast<double>(memory.peak()), told = static_cast<double>(source.peak());
      std::printf("%-40s took %6.1f MB, told %6.1f MB, %.2f times\n", name, peak / 1e6, told / 1e6, told / peak);
      EXPECT_LE(peak, told);
      EXPECT_LT(telling, 1 << 20) << "telling takes much itself";
      EXPECT_GT(6 * peak + (4 << 20), told) << "what is refused would have fit";
    }
  }
}

TEST(MemoryEstimate, SaysWhatWouldFit) {
  const std::string file = testing::to_off(testing::tetrahedron());
  const auto prepared = [&](std::uint64_t points, std::uint64_t most) {
    testing::CountingSource source(most);
    return preprocess({"t.off", file}, {.points = points, .omega = 25}, {.memory = &source}).status();
  };
  constexpr std::uint64_t kMost = 200'000'000;
  const absl::Status refused = prepared(4'000'000, kMost);
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.message()),
              HasSubstr("t.off: to prepare 4 triangles for 4000000 points with omega 25 takes 2"));
  // It means what it says.
  unsigned long points = 0;
  const std::size_t at = refused.message().find(", and ");
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(std::sscanf(refused.message().data() + at, ", and %lu points would fit", &points), 1);
  EXPECT_TRUE(prepared(points, kMost).ok());
  EXPECT_FALSE(prepared(2 * points, kMost).ok());
  const std::string great = testing::to_off(testing::icosphere(7));
  testing::CountingSource source(60'000'000);
  EXPECT_THAT(std::string(preprocess({"great.off", great}, {.points = 1}, {.memory = &source}).status().message()),
              HasSubstr("triangles would fit"));
  EXPECT_THAT(std::string(prepared(1, 1'000).message()), HasSubstr("t.off: to read"));
}

TEST(MemoryEstimate, OfACurveIsToldBeforeAnythingIsRead) {
  const std::string file = testing::to_off(testing::tetrahedron());
  constexpr std::uint64_t kMost = 200'000'000;
  const auto told = [](std::uint64_t points, std::uint64_t most, std::uint64_t* bytes = nullptr) {
    testing::CountingSource source(most);
    const ExecutionContext context{.memory = &source};
    MemoryClaim claim(context);
    const absl::Status status = claim_curve("t.off", {.points = points, .omega = 25}, context, claim);
    if (bytes != nullptr) *bytes = claim.bytes();
    return status;
  };
  const absl::Status refused = told(4'000'000, kMost);
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("t.off: a curve for 4000000 points with omega 25 takes 2"));
  unsigned long points = 0;
  const std::size_t at = refused.message().find(", and ");
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(std::sscanf(refused.message().data() + at, ", and %lu points would fit", &points), 1);
  EXPECT_TRUE(told(points, kMost).ok());
  // Nothing is refused that would be made after all.
  std::uint64_t bytes = 0;
  ASSERT_TRUE(told(20'000, kMost, &bytes).ok());
  testing::CountingSource source;
  ASSERT_TRUE(preprocess({"t.off", file}, {.points = 20'000, .omega = 25}, {.memory = &source}).ok());
  EXPECT_GT(bytes, 0u);
  EXPECT_LE(bytes, source.peak());
}

}  // namespace
}  // namespace curvecast
