// glTF with Draco, meshopt and WebP: what comes out is what went in.
#include "tests/core/mesh_io/packed_gltf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/mesh_io/mesh_companions.h"
#include "core/mesh_io/mesh_io.h"
#include "core/mesh_io/unpacking_bytes.h"
#include "tests/core/mesh_io/image_writers.h"
#include "tests/core/mesh_io/test_companions.h"

namespace curvecast {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Triangle = std::array<std::array<double, 3>, 3>;

/// The triangles in any order, each from its smallest corner on: coders may turn them.
std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<Triangle> triangles_of(const PolygonSoup& soup) {
  std::vector<Triangle> triangles(soup.polygon_count());
  for (std::size_t i = 0; i < soup.indices.size(); ++i) {
    const Vec3d& p = soup.positions[soup.indices[i]];
    triangles[i / 3][i % 3] = {p.x(), p.y(), p.z()};
  }
  return sorted(triangles);
}

std::vector<Triangle> triangles_of(const FileMesh& mesh) {
  std::vector<Triangle> triangles;
  for (const auto& face : mesh.faces) {
    const auto corner = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(face[i])]; };
    triangles.push_back({corner(0), corner(1), corner(2)});
  }
  return sorted(triangles);
}

/// A bumpy sheet of n x n squares; every coordinate is exact as a float.
FileMesh sheet(int n) {
  FileMesh mesh;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) mesh.vertices.push_back({x * 0.5, y * 0.25, (x * x + 3 * y) % 7 * 0.125});
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const int v = y * (n + 1) + x;
      mesh.faces.push_back({v, v + 1, v + n + 2});
      mesh.faces.push_back({v, v + n + 2, v + n + 1});
    }
  }
  return mesh;
}

TEST(PackedGltf, DracoGivesTheSameTriangles) {
  for (const bool sequential : {false, true}) {
    for (const int metadata : {0, 100}) {
      for (const FileMesh& mesh : {tetrahedron(), sheet(30)}) {
        const GltfWriter writer = gltf_with_draco(mesh, draco_bytes(mesh, {}, {.sequential = sequential, .metadata = metadata}));
        for (const std::string& file : {writer.glb(), writer.embedded()}) {
          const PolygonSoup soup = soup_of(file);
          EXPECT_EQ(triangles_of(soup), triangles_of(mesh));
          EXPECT_EQ(soup.positions.size(), mesh.vertices.size());
          EXPECT_THAT(soup.warnings, IsEmpty());
        }
      }
    }
  }
}

TEST(PackedGltf, DracoKeepsColoursAtTheirVertices) {
  const FileMesh mesh = tetrahedron();
  const std::vector<std::uint8_t> colours = {0, 0, 0, 255, 0, 255, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255};  // vertex 1 is green
  const PolygonSoup soup = soup_of(gltf_with_draco(mesh, draco_bytes(mesh, colours), true).glb());
  ASSERT_EQ(soup.attributes.colours.size(), soup.positions.size());
  int green = 0;
  for (std::size_t v = 0; v < soup.positions.size(); ++v) {
    const bool is_it = soup.positions[v] == Vec3d(1, 0, 0);
    EXPECT_EQ(soup.attributes.colours[v], (Rgba8{0, static_cast<std::uint8_t>(is_it ? 255 : 0), 0, 255})) << v;
    green += is_it ? 1 : 0;
  }
  EXPECT_EQ(green, 1);
}

TEST(PackedGltf, DracoIsDecodedOnceForAllInstances) {
  const FileMesh mesh = sheet(10);
  GltfWriter writer = gltf_with_draco(mesh, draco_bytes(mesh));
  writer.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"scale", {-1, 1, 1}}}};
  for (int i = 0; i < 50; ++i) writer.json["nodes"].push_back({{"mesh", 0}});
  const PolygonSoup soup = soup_of(writer.glb());
  EXPECT_EQ(soup.polygon_count(), 52 * mesh.faces.size());
  EXPECT_EQ(soup.positions.size(), 52 * mesh.vertices.size());
}

TEST(PackedGltf, DracoCountsMayBeLessThanTheAccessorsClaim) {
  const FileMesh mesh = tetrahedron();
  GltfWriter writer = gltf_with_draco(mesh, draco_bytes(mesh));
  writer.json["accessors"][0]["count"] = 100;
  writer.json["accessors"][1]["count"] = 300;
  EXPECT_EQ(triangles_of(soup_of(writer.glb())), triangles_of(mesh));
}

TEST(PackedGltf, MeshoptGivesTheSameTriangles) {
  for (const bool as_triangles : {false, true}) {
    for (const FileMesh& mesh : {tetrahedron(), sheet(30)}) {
      const PolygonSoup soup = soup_of(gltf_with_meshopt(mesh, as_triangles).glb());
      EXPECT_EQ(triangles_of(soup), triangles_of(mesh));
      EXPECT_THAT(soup.warnings, IsEmpty());
    }
  }
}

TEST(PackedGltf, MeshoptFilters) {
  const FileMesh mesh = tetrahedron();
  GltfWriter writer = gltf_with_meshopt(mesh);
  // Octahedral with 8 bits: x and y of 127, z the 127 that stands for one.
  std::string normals, places;
  for (const auto& n : std::vector<std::array<std::int8_t, 3>>{{127, 0, 127}, {0, 127, 127}, {0, 0, 127}, {-127, 0, 127}}) {
    for (const std::int8_t c : n) append(normals, c);
    append(normals, std::int8_t{0});
  }
  // Exponential: mantissas of 24 bits, and -1 for halves.
  for (const auto& v : mesh.vertices) {
    for (const double c : v) append(places, static_cast<std::uint32_t>(0xFF000000 | static_cast<std::uint32_t>(2 * c)));
  }
  writer.json["accessors"][0]["bufferView"] = meshopt_view(writer, places, 12, "EXPONENTIAL");
  const int view = meshopt_view(writer, normals, 4, "OCTAHEDRAL");
  writer.json["accessors"].push_back(
      {{"bufferView", view}, {"componentType", 5120}, {"normalized", true}, {"count", 4}, {"type", "VEC3"}});
  writer.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 2;
  const PolygonSoup soup = soup_of(writer.glb());
  EXPECT_EQ(triangles_of(soup), triangles_of(mesh));
  ASSERT_EQ(soup.attributes.normals.size(), 4u);
  EXPECT_LT((soup.attributes.normals[0] - Vec3f(1, 0, 0)).norm(), 1e-6F);
  EXPECT_LT((soup.attributes.normals[1] - Vec3f(0, 1, 0)).norm(), 1e-6F);
  EXPECT_LT((soup.attributes.normals[2] - Vec3f(0, 0, 1)).norm(), 1e-6F);
  EXPECT_LT((soup.attributes.normals[3] - Vec3f(-1, 0, 0)).norm(), 1e-6F);
}

TEST(PackedGltf, FallbackBuffersAreNotAskedFor) {
  GltfWriter writer = gltf_with_meshopt(tetrahedron());
  json whole = json::parse(writer.text("packed.bin"));
  whole["buffers"].push_back(
      {{"byteLength", 100}, {"uri", "plain.bin"}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  const Companions none, companions = {{"packed.bin", writer.bytes}};
  const std::string text = whole.dump();
  EXPECT_THAT(*mesh_companions(mesh_file("a.gltf", text, none)), ElementsAre("packed.bin"));
  EXPECT_EQ(soup_of(text, companions).polygon_count(), 4u);
}

TEST(PackedGltf, WebpTextures) {
  const Image wood = plain_image(4, 2, 10, 20, 30);
  GltfWriter writer = gltf_tetrahedron();
  writer.json["meshes"][0]["primitives"][0]["material"] = 0;
  writer.json["images"] = {{{"uri", "wood.png"}}, {{"uri", "wood.webp"}}};
  writer.json["textures"] = {{{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
  writer.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  writer.json["extensionsRequired"] = {"EXT_texture_webp"};
  const Companions none, companions = {{"wood.webp", webp_file(wood)}};
  const std::string file = writer.glb();
  EXPECT_THAT(*mesh_companions(mesh_file("a.glb", file, none)), ElementsAre("wood.webp"));
  const PolygonSoup soup = soup_of(file, companions);
  EXPECT_THAT(soup.warnings, IsEmpty());
  ASSERT_EQ(soup.attributes.materials.size(), 1u);
  ASSERT_NE(soup.attributes.materials[0].texture, nullptr);
  EXPECT_EQ(soup.attributes.materials[0].texture->rgba, wood.rgba);
}

TEST(PackedGltf, WhatItUnpacksToIsToldBefore) {
  const FileMesh mesh = sheet(100);
  const auto told = [](const std::string& bytes) {
    return unpacking_bytes({.name = "a.glb", .bytes = std::span<const char>(bytes)});
  };
  EXPECT_EQ(told(gltf_tetrahedron().glb()), 0u);
  const std::uint64_t soup = 24 * mesh.vertices.size() + 16 * mesh.faces.size();
  for (const GltfWriter& writer : {gltf_with_draco(mesh, draco_bytes(mesh)), gltf_with_meshopt(mesh)}) {
    EXPECT_GT(told(writer.glb()), soup);
    EXPECT_LT(told(writer.glb()), 30 * soup);
  }
  // What is refused for its claims asks for no more than what is not.
  GltfWriter writer = gltf_with_draco(mesh, draco_bytes(mesh));
  for (json& accessor : writer.json["accessors"]) accessor["count"] = UINT64_MAX;
  EXPECT_LT(told(writer.glb()), std::uint64_t{1} << 32);
}

}  // namespace
}  // namespace curvecast
