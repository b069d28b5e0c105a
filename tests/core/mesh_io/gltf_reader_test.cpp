#include "core/mesh_io/gltf/gltf_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/mesh_io/mesh_io.h"
#include "tests/core/mesh_io/gltf_writer.h"
#include "tests/core/mesh_io/image_writers.h"
#include "tests/core/mesh_io/test_companions.h"

namespace curvecast {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void expect_refused(const std::string& bytes, const std::string& message) {
  const Companions none;
  const absl::StatusOr<PolygonSoup> soup = read_mesh(mesh_file("a.gltf", bytes, none));
  EXPECT_EQ(soup.status().code(), absl::StatusCode::kInvalidArgument) << soup.status();
  EXPECT_THAT(std::string(soup.status().message()), HasSubstr(message));
}

std::vector<Vec3d> corners_of(const PolygonSoup& soup) {
  std::vector<Vec3d> corners;
  for (const std::uint32_t index : soup.indices) corners.push_back(soup.positions[index]);
  return corners;
}

/// A triangle of known vertices, in any mode.
GltfWriter triangle_strip(int mode, const std::vector<std::uint8_t>& indices) {
  GltfWriter writer;
  json primitive = {{"mode", mode},
                    {"attributes", {{"POSITION", writer.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3")}}}};
  if (!indices.empty()) primitive["indices"] = writer.accessor(indices, "SCALAR", 5121);
  writer.mesh(primitive);
  return writer;
}

TEST(GltfReader, TheSameMeshFromEveryContainer) {
  const GltfWriter writer = gltf_tetrahedron();
  const Companions companions = {{"my mesh.bin", writer.bytes}};
  for (const std::string& file :
       {writer.embedded(), writer.glb(), writer.text("my%20mesh.bin"), "\xEF\xBB\xBF \n" + writer.embedded()}) {
    const PolygonSoup soup = soup_of(file, companions);
    EXPECT_FALSE(soup.shares_vertices);
    EXPECT_THAT(soup.indices, ElementsAre(0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3));
    EXPECT_THAT(soup.polygon_begin, ElementsAre(0, 3, 6, 9, 12));
    EXPECT_EQ(soup.positions, (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_THAT(soup.warnings, IsEmpty());
    EXPECT_EQ(*detect_mesh_format("upload", file), MeshFormat::kGltf);
  }
  expect_refused(writer.text("mesh.bin"), "buffer 0 is in the file 'mesh.bin', which is not there");
}

TEST(GltfReader, StripsAndFansKeepTheirOrientation) {
  EXPECT_THAT(soup_of(triangle_strip(5, {}).glb()).indices, ElementsAre(0, 1, 2, 1, 3, 2, 2, 3, 4));
  EXPECT_THAT(soup_of(triangle_strip(5, {4, 3, 2, 1}).glb()).indices, ElementsAre(4, 3, 2, 3, 1, 2));
  EXPECT_THAT(soup_of(triangle_strip(6, {}).glb()).indices, ElementsAre(0, 1, 2, 0, 2, 3, 0, 3, 4));
  EXPECT_THAT(soup_of(triangle_strip(4, {}).glb()).indices, ElementsAre(0, 1, 2));
  for (const int points : {0, 1, 2, 3}) expect_refused(triangle_strip(points, {}).glb(), "no faces");
  expect_refused(triangle_strip(7, {}).glb(), "mesh 0, primitive 0: there is no mode 7");
  expect_refused(triangle_strip(4, {0, 1, 5}).glb(), "vertex index 5 is out of range");
}

TEST(GltfReader, NodesMoveTurnAndMirrorTheirMeshes) {
  GltfWriter writer = gltf_tetrahedron();
  const double half = std::numbers::sqrt2 / 2;
  writer.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                          {{"children", {2}}, {"rotation", {0, 0, half, half}}},  // x to y
                          {{"mesh", 0}, {"scale", {2, 1, 1}}},
                          {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}}};
  const PolygonSoup soup = soup_of(writer.glb());
  ASSERT_EQ(soup.polygon_count(), 8u);
  EXPECT_LT((soup.positions[1] - Vec3d(10, 2, 0)).norm(), 1e-12);
  EXPECT_LT((soup.positions[2] - Vec3d(9, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(soup.positions[5], Vec3d(-1, 0, 5));
  // Both keep their outside outside.
  const std::vector<Vec3d> corners = corners_of(soup);
  for (const std::size_t half_of : {0u, 12u}) {
    double volume = 0;
    for (std::size_t i = half_of; i < half_of + 12; i += 3) volume += corners[i].dot(corners[i + 1].cross(corners[i + 2])) / 6;
    EXPECT_GT(volume, 0.1);
  }
  const absl::StatusOr<RepairedMesh> mesh = repair(soup);
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(analyse_topology(mesh->mesh).components, 2u);
  EXPECT_EQ(mesh->report.flipped_faces, 0u);
}

TEST(GltfReader, TheDefaultSceneCounts) {
  GltfWriter writer = gltf_tetrahedron();
  writer.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}};
  writer.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  EXPECT_EQ(soup_of(writer.glb()).polygon_count(), 8u);
  writer.json["scene"] = 1;
  EXPECT_EQ(soup_of(writer.glb()).polygon_count(), 4u);
  EXPECT_EQ(soup_of(writer.glb()).positions[0], Vec3d(5, 0, 0));
  writer.json["scene"] = 2;
  expect_refused(writer.glb(), "there is no scene 2");
}

TEST(GltfReader, ColoursOfAnyTypeBecomeSrgb) {
  for (const int kind : {0, 1, 2}) {
    GltfWriter writer;
    json primitive = writer.primitive(tetrahedron());
    int colours = 0;
    if (kind == 0) colours = writer.floats({1, 0.5, 0, 2, -1, 0.2159F, 0, 0, 0, 1, 1, 1}, "VEC3");
    if (kind == 1) {
      colours = writer.accessor(std::vector<std::uint8_t>{255, 128, 0, 255, 255, 0, 55, 255, 0, 0, 0, 64, 255, 255, 255, 255},
                                "VEC4", 5121, true);
    }
    if (kind == 2) {
      colours = writer.accessor(std::vector<std::uint16_t>{65535, 32768, 0, 65535, 0, 14149, 0, 0, 0, 65535, 65535, 65535},
                                "VEC3", 5123, true);
    }
    primitive["attributes"]["COLOR_0"] = colours;
    writer.mesh(primitive);
    const PolygonSoup soup = soup_of(writer.glb());
    ASSERT_EQ(soup.attributes.colours.size(), 4u);
    EXPECT_EQ(soup.attributes.colours[0], (Rgba8{255, 188, 0, 255})) << kind;
    EXPECT_NEAR(soup.attributes.colours[1].b, 128, 1) << kind;
    EXPECT_EQ(soup.attributes.colours[2], (Rgba8{0, 0, 0, static_cast<std::uint8_t>(kind == 1 ? 64 : 255)})) << kind;
    EXPECT_EQ(soup.attributes.colours[3], Rgba8{});
  }
}

TEST(GltfReader, QuantisedPositionsAndNormals) {
  GltfWriter writer;
  writer.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const int places = writer.accessor(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 0, -32767, 0}, "VEC3", 5122, true);
  const int normals = writer.accessor(std::vector<std::int8_t>{0, 0, 127, 0, 0, 127, 0, 0, -128}, "VEC3", 5120, true);
  writer.mesh({{"attributes", {{"POSITION", places}, {"NORMAL", normals}}}});
  writer.json["nodes"] = {{{"mesh", 0}, {"scale", {2, 2, 2}}}};
  const PolygonSoup soup = soup_of(writer.glb());
  EXPECT_EQ(soup.positions, (std::vector<Vec3d>{{0, 0, 0}, {2, 0, 0}, {0, -2, 0}}));
  EXPECT_EQ(soup.attributes.normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 0, 1}, {0, 0, -1}}));
}

TEST(GltfReader, NormalsTellSharpEdges) {
  // Two triangles that meet at 90 degrees, with vertices of their own.
  const auto meant = [](const std::vector<float>& normals) {
    GltfWriter writer;
    const int places = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1}, "VEC3", 5126);
    const int of_them = writer.accessor(normals, "VEC3", 5126);
    writer.mesh({{"attributes", {{"POSITION", places}, {"NORMAL", of_them}}}});
    return soup_of(writer.glb()).crease_degrees;
  };
  EXPECT_EQ(meant({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 0, 1, 0}), 0);
  EXPECT_EQ(meant({0, 1, 1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 0, 1, 1, 0, 1, 0}), 180);
  EXPECT_EQ(meant({0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 0, 0, 1, 0}), std::nullopt) << "a vertex without one";
}

TEST(GltfReader, MaterialsTexturesAndTheirCoordinates) {
  const Image wood = plain_image(4, 2, 10, 20, 30);
  GltfWriter writer;
  json primitive = writer.primitive(tetrahedron());
  primitive["attributes"]["TEXCOORD_1"] = writer.floats({0, 0, 1, 0, 0, 1, 0.25, 0.75}, "VEC2");
  primitive["material"] = 0;
  json bare = writer.primitive(tetrahedron());
  writer.json["meshes"] = {{{"primitives", {primitive, bare}}}};
  writer.json["images"] = {{{"uri", "tex/wood.png"}}, {{"bufferView", writer.view(png_file(wood))}, {"mimeType", "image/png"}}};
  writer.json["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 9}}};
  const auto material = [](int texture) {
    return json{{"name", "m"},
                {"pbrMetallicRoughness",
                 {{"baseColorFactor", {1, 0.2159, 0, 0.5}}, {"baseColorTexture", {{"index", texture}, {"texCoord", 1}}}}}};
  };
  writer.json["materials"] = {material(0), material(1), material(2), material(0)};
  const Companions companions = {{"tex/wood.png", png_file(wood)}};
  const PolygonSoup soup = soup_of(writer.glb(), companions);
  const MeshAttributes& a = soup.attributes;
  ASSERT_EQ(a.materials.size(), 4u);
  EXPECT_EQ(a.materials[0].colour, (Rgba8{255, 128, 0, 128}));
  ASSERT_NE(a.materials[0].texture, nullptr);
  EXPECT_EQ(a.materials[0].texture, a.materials[3].texture);
  ASSERT_NE(a.materials[1].texture, nullptr);
  EXPECT_EQ(a.materials[1].texture->rgba, wood.rgba);
  EXPECT_EQ(a.materials[2].texture, nullptr);
  ASSERT_EQ(soup.warnings.size(), 1u);
  EXPECT_THAT(soup.warnings[0], HasSubstr("material 2: the texture 'image 9' cannot be read"));
  constexpr std::uint32_t kNo = MeshAttributes::kNoMaterial;
  EXPECT_THAT(a.material_of_face, ElementsAre(0, 0, 0, 0, kNo, kNo, kNo, kNo));
  ASSERT_EQ(a.uv.size(), soup.indices.size());
  EXPECT_EQ(a.uv[5], Vec2f(0.25, 0.25));  // vertex 3; upwards
  EXPECT_EQ(a.uv[1], Vec2f(0, 0));        // vertex 2
  EXPECT_EQ(a.uv[20], Vec2f(0, 0));
  EXPECT_THAT(soup_of(writer.glb()).warnings[0], HasSubstr("material 0: the texture 'tex/wood.png' is not there"));
}

TEST(GltfReader, TextureTransforms) {
  GltfWriter writer;
  json primitive = writer.primitive(tetrahedron());
  primitive["attributes"]["TEXCOORD_0"] = writer.floats({0, 0, 1, 0, 0, 1, 1, 1}, "VEC2");
  primitive["material"] = 0;
  writer.mesh(primitive);
  const json move = {{"offset", {0.5, 0.25}}, {"rotation", std::numbers::pi / 2}, {"scale", {2, 1}}};
  writer.json["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", move}}}}}}}}};
  const PolygonSoup soup = soup_of(writer.glb());
  ASSERT_EQ(soup.attributes.uv.size(), 12u);
  // Corner 2 is vertex 1: (1, 0), scaled to (2, 0), turned to (0, -2), moved to (0.5, -1.75), and up.
  EXPECT_LT((soup.attributes.uv[2] - Vec2f(0.5F, 2.75F)).norm(), 1e-6F);
}

TEST(GltfReader, PrimitivesShareTheirVertices) {
  GltfWriter writer;
  json primitive = writer.primitive(tetrahedron());
  writer.json["meshes"] = {{{"primitives", {primitive, primitive, primitive}}}};
  writer.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {3, 0, 0}}}};
  const PolygonSoup soup = soup_of(writer.glb());
  EXPECT_EQ(soup.positions.size(), 8u);
  EXPECT_EQ(soup.polygon_count(), 24u);
}

TEST(GltfReader, SparseAccessorsAreResolved) {
  GltfWriter writer = gltf_tetrahedron();
  const json sparse = {{"count", 1},
                       {"indices", {{"bufferView", writer.view(std::string("\x02\0", 2))}, {"componentType", 5123}}},
                       {"values", {{"bufferView", writer.view(std::string("\0\0\0\0\0\0\xE0\x40\0\0\0\0", 12))}}}};
  writer.json["accessors"][0]["sparse"] = sparse;
  EXPECT_EQ(soup_of(writer.glb()).positions[2], Vec3d(0, 7, 0));
  EXPECT_EQ(soup_of(writer.glb()).positions[1], Vec3d(1, 0, 0));
  writer.json["accessors"][0].erase("bufferView");
  EXPECT_EQ(soup_of(writer.glb()).positions[1], Vec3d(0, 0, 0));
  writer.json["accessors"][0]["count"] = 1'000'000'000;
  expect_refused(writer.glb(), "more elements than are in proportion");
  writer.json["accessors"][0]["count"] = 2;
  expect_refused(writer.glb(), "vertex index 2 is out of range");
  writer.json["accessors"][0].erase("sparse");
  expect_refused(writer.glb(), "accessor 0 (POSITION): it has no buffer view");
}

TEST(GltfReader, StridesMayLeaveGapsButNotOverlap) {
  GltfWriter writer = gltf_tetrahedron();
  std::string spread;
  for (const auto& v : tetrahedron().vertices) {
    for (const double x : v) append(spread, static_cast<float>(x));
    append(spread, 99.0F);
  }
  writer.json["accessors"][0]["bufferView"] = writer.view(spread.substr(0, spread.size() - 4), 16);
  EXPECT_EQ(soup_of(writer.glb()).positions[3], Vec3d(0, 0, 1));
  writer.json["bufferViews"].back()["byteStride"] = 20;
  expect_refused(writer.glb(), "reach beyond buffer view");
  writer.json["bufferViews"].back()["byteStride"] = 8;
  expect_refused(writer.glb(), "overlap");
}

TEST(GltfReader, PassesOverExtensionsThatChangeLooksOnly) {
  GltfWriter writer = gltf_tetrahedron();
  writer.json["extensionsRequired"] = {"KHR_materials_unlit"};
  EXPECT_THAT(soup_of(writer.glb()).warnings, ElementsAre(HasSubstr("KHR_materials_unlit")));
}

TEST(GltfReader, TruncatedGlbsAreRefused) {
  const std::string file = gltf_tetrahedron().glb();
  for (std::size_t length = 4; length < file.size(); ++length) {
    const std::string cut = file.substr(0, length);
    EXPECT_FALSE(read_mesh({"a.glb", std::span<const char>(cut)}).ok()) << length;
  }
}

}  // namespace
}  // namespace curvecast
