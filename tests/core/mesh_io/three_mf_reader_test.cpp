#include "core/mesh_io/three_mf/three_mf_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/mesh_io/mesh_io.h"
#include "core/mesh_io/unpacking_bytes.h"
#include "tests/core/mesh_io/test_companions.h"
#include "tests/core/mesh_io/three_mf_writer.h"

namespace curvecast {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kItem = "<item objectid=\"1\"/>\n";

void expect_refused(const std::string& bytes, const std::string& message) {
  const Companions none;
  const absl::StatusOr<PolygonSoup> soup = read_mesh(mesh_file("a.3mf", bytes, none));
  EXPECT_EQ(soup.status().code(), absl::StatusCode::kInvalidArgument) << soup.status();
  EXPECT_THAT(std::string(soup.status().message()), HasSubstr(message));
}

std::string tetrahedron_object(int id, const std::string& attributes = "", const std::string& extra = "") {
  return three_mf_object(id, tetrahedron(), attributes, extra);
}

TEST(ThreeMfReader, ReadsAMesh) {
  const std::string model = three_mf_model(tetrahedron_object(1), kItem);
  for (const std::string& file : {three_mf_file(model), three_mf_file(model, {}, true)}) {
    const PolygonSoup soup = soup_of(file);
    EXPECT_THAT(soup.indices, ElementsAre(0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3));
    EXPECT_THAT(soup.polygon_begin, ElementsAre(0, 3, 6, 9, 12));
    EXPECT_EQ(soup.positions, (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_TRUE(soup.shares_vertices);
    EXPECT_THAT(soup.warnings, IsEmpty());
    EXPECT_THAT(soup.attributes.materials, IsEmpty());
    EXPECT_THAT(soup.attributes.material_of_face, IsEmpty());
    EXPECT_THAT(soup.attributes.face_colours, IsEmpty());
    EXPECT_EQ(*detect_mesh_format("upload", file), MeshFormat::kThreeMf);
  }
}

TEST(ThreeMfReader, UnitsStayThoseOfTheFile) {
  for (const char* unit : {"micron", "inch", "meter"}) {
    const std::string attributes = std::string("unit=\"") + unit + "\"";
    EXPECT_EQ(soup_of(three_mf_file(three_mf_model(tetrahedron_object(1), kItem, attributes))).positions[1], Vec3d(1, 0, 0));
  }
}

TEST(ThreeMfReader, ItemsAndComponentsMoveTurnAndMirror) {
  const std::string resources = tetrahedron_object(1) +
                                "<object id=\"2\"><components><component objectid=\"1\"/>"
                                // x to y, y to -x: rows of coordinates are multiplied from the left.
                                "<component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 1 10 0 0\"/></components></object>\n";
  const PolygonSoup soup =
      soup_of(three_mf_file(three_mf_model(resources,
                                           "<item objectid=\"2\" transform=\"2 0 0 0 2 0 0 0 2 0 0 5\"/><item objectid=\"1\" "
                                           "transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>")));
  ASSERT_EQ(soup.positions.size(), 12u);
  EXPECT_EQ(soup.positions[1], Vec3d(2, 0, 5));
  EXPECT_EQ(soup.positions[5], Vec3d(20, 2, 5));
  EXPECT_EQ(soup.positions[6], Vec3d(18, 0, 5));
  EXPECT_EQ(soup.positions[9], Vec3d(-1, 0, 0));
  const absl::StatusOr<RepairedMesh> mesh = repair(soup);
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(mesh->report.flipped_faces, 0u);
  EXPECT_EQ(analyse_topology(mesh->mesh).boundary_loops, 0u);
  double volume = 0;
  for (std::size_t i = 24; i < 36; i += 3) {
    const auto p = [&](std::size_t corner) { return soup.positions[soup.indices[i + corner]]; };
    volume += p(0).dot(p(1).cross(p(2))) / 6;
  }
  EXPECT_NEAR(volume, 1.0 / 6, 1e-12) << "the mirrored one keeps its outside outside";
}

TEST(ThreeMfReader, ObjectsOfOtherParts) {
  const std::string other = three_mf_model(tetrahedron_object(7), "");
  const std::string root = three_mf_model(
      "<object id=\"1\"><components><component objectid=\"7\" p:path=\"/3D/Objects/o.model\"/>"
      "<component objectid=\"7\" p:path=\"/3D/OBJECTS/o.model\" transform=\"1 0 0 0 1 0 0 0 1 3 0 0\"/></components></object>",
      kItem + "<item objectid=\"7\" p:path=\"/3D/Objects/o.model\" transform=\"1 0 0 0 1 0 0 0 1 6 0 0\"/>",
      "requiredextensions=\"p\"");
  const PolygonSoup soup = soup_of(three_mf_file(root, {{"3D/Objects/o.model", other}}));
  ASSERT_EQ(soup.positions.size(), 12u);
  EXPECT_EQ(soup.positions[4], Vec3d(3, 0, 0));
  EXPECT_EQ(soup.positions[8], Vec3d(6, 0, 0));
  expect_refused(three_mf_file(root), "the part '3D/Objects/o.model' is not in the archive");
}

TEST(ThreeMfReader, BaseMaterials) {
  const std::string resources =
      "<basematerials id=\"5\"><base name=\"red\" displaycolor=\"#FF0000\"/><base name=\"glass\" displaycolor=\"#0000ff80\"/>"
      "</basematerials>" +
      tetrahedron_object(1, "pid=\"5\" pindex=\"1\"") + tetrahedron_object(2) + tetrahedron_object(3, "", " pid=\"5\" p1=\"0\"");
  const PolygonSoup soup =
      soup_of(three_mf_file(three_mf_model(resources, "<item objectid=\"1\"/><item objectid=\"2\"/><item objectid=\"3\"/>")));
  const MeshAttributes& a = soup.attributes;
  ASSERT_EQ(a.materials.size(), 2u);
  EXPECT_EQ(a.materials[0].name, "red");
  EXPECT_EQ(a.materials[0].colour, (Rgba8{255, 0, 0, 255}));
  EXPECT_EQ(a.materials[1].colour, (Rgba8{0, 0, 255, 128}));
  constexpr std::uint32_t kNo = MeshAttributes::kNoMaterial;
  EXPECT_THAT(a.material_of_face, ElementsAre(1, 1, 1, 1, kNo, kNo, kNo, kNo, 0, 0, 0, 0));
  EXPECT_THAT(soup.warnings, IsEmpty());
}

TEST(ThreeMfReader, ColourGroups) {
  const std::string resources =
      "<m:colorgroup id=\"5\"><m:color color=\"#FF0000\"/><m:color color=\"#00FF00FF\"/><m:color "
      "color=\"#000060\"/></m:colorgroup>" +
      tetrahedron_object(1) + tetrahedron_object(2, "pid=\"5\" pindex=\"0\"", " p1=\"1\"") +
      tetrahedron_object(3, "pid=\"5\" pindex=\"0\"", " p1=\"0\" p2=\"1\" p3=\"2\"");
  const PolygonSoup soup = soup_of(three_mf_file(three_mf_model(
      resources, "<item objectid=\"1\"/><item objectid=\"2\"/><item objectid=\"3\"/>", "requiredextensions=\"m\"")));
  ASSERT_EQ(soup.attributes.face_colours.size(), 12u);
  EXPECT_EQ(soup.attributes.face_colours[0], Rgba8{});
  EXPECT_EQ(soup.attributes.face_colours[4], (Rgba8{0, 255, 0, 255}));
  EXPECT_EQ(soup.attributes.face_colours[8], (Rgba8{85, 85, 32, 255}));
}

TEST(ThreeMfReader, OtherPropertiesAreWarnedOfOnce) {
  const std::string textures =
      "<m:texture2d id=\"8\" path=\"/t.png\" contenttype=\"image/png\"/><m:texture2dgroup id=\"9\" texid=\"8\"><m:tex2coord "
      "u=\"0\" "
      "v=\"0\"/></m:texture2dgroup>";
  const PolygonSoup soup = soup_of(three_mf_file(three_mf_model(
      "<metadata name=\"a\">b</metadata>" + textures + textures + tetrahedron_object(1, "", " pid=\"9\" p1=\"0\""), kItem)));
  EXPECT_EQ(soup.polygon_count(), 4u);
  EXPECT_THAT(soup.warnings, ElementsAre(HasSubstr("'texture2d'"), HasSubstr("'texture2dgroup'")));
}

TEST(ThreeMfReader, NamesThePlaceOfAFault) {
  const auto mesh = [](const std::string& vertices, const std::string& triangles) {
    return three_mf_file(three_mf_model("<object id=\"1\"><mesh><vertices>\n" + vertices + "</vertices><triangles>\n" +
                                            triangles + "</triangles></mesh></object>",
                                        kItem));
  };
  const std::string three =
      "<vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/>\n";
  expect_refused(mesh("<vertex x=\"0\" y=\"a\" z=\"0\"/>", ""), "3D/3dmodel.model: line 5: y is 'a', which is none");
  expect_refused(mesh("<vertex x=\"0\" y=\"nan\" z=\"0\"/>", ""), "line 5: a coordinate is not a finite number");
  expect_refused(mesh("<vertex x=\"0\" y=\"0\"/>", ""), "line 5: a vertex has no z");
  expect_refused(mesh(three, "<triangle v1=\"0\" v2=\"1\" v3=\"3\"/>"), "line 7: vertex index 3 is out of range (the file has 3");
  expect_refused(mesh(three, "<triangle v1=\"0\" v2=\"1\" v3=\"-1\"/>"), "line 7: v3 is '-1', which is none");
  expect_refused(mesh(three, "<triangle v1=\"0\" v2=\"1\"/>"), "line 7: there is no v3");
  expect_refused(mesh(three, ""), "no faces");
  EXPECT_EQ(soup_of(mesh(three, "<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>")).polygon_count(), 1u);
}

TEST(ThreeMfReader, WhatItUnpacksToIsToldBefore) {
  FileMesh mesh = tetrahedron();
  for (int i = 0; i < 2'000; ++i) mesh.vertices.push_back({1, 1, 1});
  const std::string model = three_mf_model(three_mf_object(1, mesh), kItem);
  const std::string file = three_mf_file(model, {{"Metadata/other.txt", std::string(50'000, 'x')}});
  const std::uint64_t told = unpacking_bytes({.name = "a.3mf", .bytes = std::span<const char>(file)});
  EXPECT_GT(told, model.size());
  EXPECT_LT(told, 8 * model.size());
  EXPECT_EQ(three_mf_unpacked_bytes(std::span<const char>(file)), model.size());
}

TEST(ThreeMfReader, IsCancelled) {
  std::atomic<bool> cancel = true;
  const std::string file = three_mf_tetrahedron();
  EXPECT_TRUE(
      absl::IsCancelled(read_three_mf({.name = "a.3mf", .bytes = std::span<const char>(file)}, {.cancel = &cancel}).status()));
}

}  // namespace
}  // namespace curvecast
