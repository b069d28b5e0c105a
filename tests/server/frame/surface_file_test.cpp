#include "server/frame/surface_file.h"

#include <draco/compression/decode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <vector>

#include "core/base/memory_claim.h"
#include "core/curve/surface_colour.h"
#include "core/mesh/pair_halfedges.h"
#include "core/mesh/repair.h"
#include "tests/support/counted_memory.h"
#include "tests/support/shapes.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

/// A mesh and what is known of it, which a base looks at.
struct Surface {
  explicit Surface(PolygonSoup soup) {
    absl::StatusOr<RepairedMesh> repaired = repair(std::move(soup));
    EXPECT_TRUE(repaired.ok()) << repaired.status();
    mesh = std::move(repaired->mesh);
    attributes = std::move(repaired->attributes);
    if (has_colour(attributes)) colour = std::make_unique<SurfaceColour>(mesh, attributes);
    base = std::make_unique<CurveBase>(SurfaceData(mesh, {}, {}, attributes, colour.get()), std::span<const Chart>());
  }

  TriangleMesh mesh;
  MeshAttributes attributes;
  std::unique_ptr<SurfaceColour> colour;
  std::unique_ptr<CurveBase> base;
};

std::unique_ptr<draco::Mesh> decode(const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  EXPECT_TRUE(mesh.ok()) << mesh.status().error_msg_string();
  return mesh.ok() ? std::move(mesh).value() : nullptr;
}

std::vector<Triangle> triangles_of(const draco::Mesh& mesh) {
  std::vector<Triangle> triangles(mesh.num_faces());
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
    triangles[f] = {face[0].value(), face[1].value(), face[2].value()};
  }
  return triangles;
}

Vec3f value_of(const draco::Mesh& mesh, draco::GeometryAttribute::Type type, std::uint32_t point) {
  const draco::PointAttribute& attribute = *mesh.GetNamedAttribute(type);
  float value[3];
  EXPECT_TRUE((attribute.ConvertValue<float, 3>(attribute.mapped_index(draco::PointIndex(point)), value)));
  return {value[0], value[1], value[2]};
}

TEST(SurfaceFile, HasTheWholeMeshWhereItIs) {
  const Vec3d far(1e6, -2e6, 0.5e6);
  const Surface torus(testing::translated(testing::torus(40, 60), far));
  for (const int bits : {kLeastSurfaceBits, kSurfaceBits, kMostSurfaceBits}) {
    const auto file = make_surface_file(*torus.base, far, bits, {});
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->vertices, torus.mesh.positions.size());
    EXPECT_EQ(file->triangles, torus.mesh.triangles.size());
    EXPECT_EQ(file->origin, far);
    const auto mesh = decode(file->bytes);
    ASSERT_NE(mesh, nullptr);
    EXPECT_EQ(mesh->num_points(), file->vertices);
    EXPECT_EQ(mesh->num_faces(), file->triangles);
    const HalfedgePairs pairs = pair_halfedges(triangles_of(*mesh), mesh->num_points());
    EXPECT_TRUE(pairs.border.empty() && pairs.nonmanifold_edges == 0 && pairs.is_oriented);
    const double step = 2.6 / std::pow(2, bits), rounding = 1e-6;
    for (std::uint32_t v = 0; v < mesh->num_points(); ++v) {
      const Vec3d p = value_of(*mesh, draco::GeometryAttribute::POSITION, v).cast<double>();
      const double tube = std::hypot(std::hypot(p.x(), p.y()) - 1, p.z());
      ASSERT_NEAR(tube, 0.3, step + rounding) << bits;
    }
  }
}

TEST(SurfaceFile, KeepsBordersAndPieces) {
  const Surface pieces(testing::merged(testing::open_cylinder(8, 20), testing::translated(testing::disc(5, 12), {5, 0, 0})));
  const auto file = make_surface_file(*pieces.base, Vec3d::Zero(), kSurfaceBits, {});
  ASSERT_TRUE(file.ok()) << file.status();
  const auto mesh = decode(file->bytes);
  ASSERT_NE(mesh, nullptr);
  const HalfedgePairs pairs = pair_halfedges(triangles_of(*mesh), mesh->num_points());
  EXPECT_EQ(pairs.border.size(), pair_halfedges(pieces.mesh.triangles, pieces.mesh.positions.size()).border.size());
}

TEST(SurfaceFile, HasTheVerticesColours) {
  PolygonSoup soup = testing::icosphere(3);
  for (const Vec3d& p : soup.positions) {
    soup.attributes.colours.push_back(p.z() > 0 ? Rgba8{250, 10, 20, 255} : Rgba8{0, 90, 200, 255});
  }
  const Surface ball(std::move(soup));
  const auto file = make_surface_file(*ball.base, Vec3d::Zero(), kSurfaceBits, {});
  ASSERT_TRUE(file.ok()) << file.status();
  const auto mesh = decode(file->bytes);
  ASSERT_NE(mesh, nullptr);
  for (std::uint32_t v = 0; v < mesh->num_points(); ++v) {
    const Vec3f p = value_of(*mesh, draco::GeometryAttribute::POSITION, v);
    if (std::abs(p.z()) < 1e-3) continue;
    const Vec3f wanted = p.z() > 0 ? Vec3f(250, 10, 20) : Vec3f(0, 90, 200);
    ASSERT_LE((value_of(*mesh, draco::GeometryAttribute::COLOR, v) - wanted).cwiseAbs().maxCoeff(), 1);
  }
}

TEST(SurfaceFile, IsRefusedWhereTrianglesAloneWouldLackColours) {
  PolygonSoup by_face = testing::tetrahedron(), by_material = by_face;
  by_face.attributes.face_colours.assign(4, Rgba8{1, 2, 3, 255});
  by_face.attributes.face_colours[2] = Rgba8{200, 2, 3, 255};
  by_material.attributes.materials = {{"red", {200, 0, 0, 255}, nullptr}, {"blue", {0, 0, 200, 255}, nullptr}};
  by_material.attributes.material_of_face = {0, 1, 0, 1};
  for (const PolygonSoup& soup : {by_face, by_material}) {
    const Surface surface(soup);
    const auto file = make_surface_file(*surface.base, Vec3d::Zero(), kSurfaceBits, {});
    EXPECT_EQ(file.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(file.status().message(), HasSubstr("textures, or colours of faces"));
  }
}

TEST(SurfaceFile, IsRefusedWhereItIsTooLarge) {
  const TriangleMesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          .triangles = std::vector<Triangle>(kMaxSurfaceFaces + 1, Triangle{0, 1, 2})};
  const CurveBase base(SurfaceData(mesh, {}, {}, {}), std::span<const Chart>());
  const auto file = make_surface_file(base, Vec3d::Zero(), kSurfaceBits, {});
  EXPECT_EQ(file.status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_THAT(file.status().message(), HasSubstr("1000001 triangles"));
}

TEST(SurfaceFile, AsksForMemoryAndEndsWhenItIsCancelled) {
  const Surface ball(testing::icosphere(4));
  struct NoMemory : MemorySource {
    absl::Status take(std::uint64_t bytes, const std::string& what) override {
      asked = bytes;
      return absl::ResourceExhaustedError(what);
    }
    void give_back(std::uint64_t /*bytes*/) override {}
    std::uint64_t most() const override { return 0; }
    std::uint64_t asked = 0;
  } nothing;
  ExecutionContext context;
  context.memory = &nothing;
  EXPECT_EQ(make_surface_file(*ball.base, Vec3d::Zero(), kSurfaceBits, context).status().code(),
            absl::StatusCode::kResourceExhausted);
  EXPECT_GE(nothing.asked, 100 * ball.mesh.triangles.size());
  const std::atomic<bool> cancel = true;
  context = {};
  context.cancel = &cancel;
  EXPECT_EQ(make_surface_file(*ball.base, Vec3d::Zero(), kSurfaceBits, context).status().code(), absl::StatusCode::kCancelled);
}

TEST(SurfaceFile, TakesNoMoreMemoryThanItAsksFor) {
  for (const int level : {5, 7}) {
    Surface ball(testing::jittered(testing::icosphere(level), 1e-3));
    struct Source : MemorySource {
      absl::Status take(std::uint64_t bytes, const std::string& /*what*/) override {
        asked = bytes;
        return absl::OkStatus();
      }
      void give_back(std::uint64_t /*bytes*/) override {}
      std::uint64_t most() const override { return UINT64_MAX; }
      std::uint64_t asked = 0;
    } source;
    ExecutionContext context;
    context.memory = &source;
    const testing::CountedMemory memory;
    ASSERT_TRUE(make_surface_file(*ball.base, Vec3d::Zero(), kSurfaceBits, context).ok());
    EXPECT_LE(memory.peak(), source.asked) << level;
    EXPECT_GE(memory.peak(), source.asked / 2) << level << ": it asks for far too much";
  }
}

TEST(SurfaceFiles, MakesAFileOnceAndKeepsTheNewest) {
  SurfaceFiles files;
  int made = 0;
  const auto of_size = [&](std::size_t bytes) {
    return [&made, bytes]() -> absl::StatusOr<SurfaceFile> {
      ++made;
      return SurfaceFile{.bytes = std::string(bytes, 'x')};
    };
  };
  EXPECT_EQ((*files.get("a", 14, of_size(10)))->bytes.size(), 10u);
  EXPECT_EQ((*files.get("a", 14, of_size(11)))->bytes.size(), 10u);
  EXPECT_EQ((*files.get("a", 12, of_size(12)))->bytes.size(), 12u);
  EXPECT_EQ((*files.get("b", 14, of_size(13)))->bytes.size(), 13u);
  EXPECT_EQ(made, 3);
  EXPECT_EQ(files.get("c", 14, [] { return absl::StatusOr<SurfaceFile>(absl::CancelledError("gone")); }).status().code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ((*files.get("c", 14, of_size(1)))->bytes.size(), 1u);
  // Those used longest ago go: "b" is used again, "a" is not.
  constexpr std::size_t kMuch = std::size_t{16} << 20;
  ASSERT_TRUE(files.get("d", 14, of_size(kMuch)).ok());
  ASSERT_TRUE(files.get("b", 14, of_size(13)).ok());
  ASSERT_TRUE(files.get("e", 14, of_size(kMuch)).ok());
  made = 0;
  EXPECT_EQ((*files.get("b", 14, of_size(13)))->bytes.size(), 13u);
  EXPECT_EQ(made, 0);
  EXPECT_EQ((*files.get("a", 14, of_size(11)))->bytes.size(), 11u);
  EXPECT_EQ(made, 1);
  // What is larger than all that is kept is handed out, and forgotten.
  EXPECT_EQ((*files.get("f", 14, of_size(3 * kMuch)))->bytes.size(), 3 * kMuch);
  EXPECT_EQ((*files.get("f", 14, of_size(7)))->bytes.size(), 7u);
}

}  // namespace
}  // namespace curvecast::server
