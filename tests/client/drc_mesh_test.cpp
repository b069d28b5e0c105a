#include "client/lib/drc_mesh.h"

#include <draco/compression/decode.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace curvecast::client {
namespace {

/// A tetrahedron with colours, far from the origin.
Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices.origin = {1000, 0, -2000};
  mesh.vertices.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const float s = std::sqrt(1.0f / 3);
  mesh.vertices.normals = {{-s, -s, -s}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.vertices.colours = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {1, 2, 3}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

TEST(DrcMesh, IsReadByDraco) {
  const Mesh mesh = tetrahedron();
  const absl::StatusOr<std::string> bytes = make_drc_mesh(mesh);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  draco::DecoderBuffer buffer;
  buffer.Init(bytes->data(), bytes->size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  ASSERT_TRUE(decoded.ok()) << decoded.status().error_msg();
  const draco::Mesh& read = *decoded.value();
  ASSERT_EQ(read.num_points(), 4u);
  ASSERT_EQ(read.num_faces(), 4u);
  const draco::PointAttribute& position = *read.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  const draco::PointAttribute& normal = *read.GetNamedAttribute(draco::GeometryAttribute::NORMAL);
  const draco::PointAttribute& colour = *read.GetNamedAttribute(draco::GeometryAttribute::COLOR);
  // Which of ours each point is: by its colour, which is kept exactly.
  std::vector<std::uint32_t> ours;
  for (std::uint32_t i = 0; i < 4; ++i) {
    std::array<std::uint8_t, 3> rgb;
    colour.GetMappedValue(draco::PointIndex(i), &rgb);
    const auto found = std::find(mesh.vertices.colours.begin(), mesh.vertices.colours.end(), rgb);
    ASSERT_NE(found, mesh.vertices.colours.end());
    const auto v = static_cast<std::uint32_t>(found - mesh.vertices.colours.begin());
    ours.push_back(v);
    std::array<float, 3> p, n;
    position.GetMappedValue(draco::PointIndex(i), &p);
    normal.GetMappedValue(draco::PointIndex(i), &n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(p[axis], mesh.vertices.positions[v][axis] + mesh.vertices.origin[axis], 2e-4);
      EXPECT_NEAR(n[axis], mesh.vertices.normals[v][axis], 5e-3);
    }
  }
  const auto first_least = [](std::array<std::uint32_t, 3> t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  std::set<std::array<std::uint32_t, 3>> wanted, found;
  for (const auto& t : mesh.triangles) wanted.insert(first_least(t));
  for (std::uint32_t f = 0; f < 4; ++f) {
    const draco::Mesh::Face& face = read.face(draco::FaceIndex(f));
    found.insert(first_least({ours[face[0].value()], ours[face[1].value()], ours[face[2].value()]}));
  }
  EXPECT_EQ(found, wanted) << "each as it was turned";
}

TEST(DrcMesh, RefusesWhatItCannotWrite) {
  EXPECT_EQ(make_drc_mesh({}).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(make_drc_mesh(tetrahedron(), {.position_bits = 31}).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(make_drc_mesh(tetrahedron(), {.normal_bits = 1}).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast::client
