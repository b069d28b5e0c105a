#include "tests/support/mesh_samples.h"

#include "tests/core/mesh_io/gltf_writer.h"
#include "tests/core/mesh_io/image_writers.h"
#include "tests/core/mesh_io/mesh_writers.h"
#include "tests/core/mesh_io/packed_gltf.h"
#include "tests/core/mesh_io/three_mf_writer.h"

namespace curvecast::testing {
namespace {

std::string everything_ply() {
  std::string file = "ply\nformat binary_little_endian 1.0\ncomment TextureFile a.png\nelement vertex 3\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "s", "t", "quality"})
    file += std::string("property float ") + name + "\n";
  for (const char* name : {"red", "green", "blue"}) file += std::string("property uchar ") + name + "\n";
  file +=
      "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (int v = 0; v < 3; ++v) {
    for (int i = 0; i < 9; ++i) append(file, static_cast<float>(v == i));
    file += "\x10\x20\x30";
  }
  for (int f = 0; f < 2; ++f) {
    file += '\3';
    for (int i = 0; i < 3; ++i) append(file, i);
    file += '\6';
    for (int i = 0; i < 6; ++i) append(file, 0.5F);
    append(file, f);
    file += "abc";
  }
  return file;
}

/// Two textured materials, one picture in the file and one beside it.
std::string everything_gltf() {
  GltfWriter writer;
  nlohmann::json primitive = writer.primitive(tetrahedron());
  primitive["attributes"]["NORMAL"] = writer.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  primitive["attributes"]["COLOR_0"] = writer.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, "VEC3");
  primitive["attributes"]["TEXCOORD_0"] = writer.floats({0, 0, 1, 0, 0, 1, 0.25, 0.75}, "VEC2");
  nlohmann::json other = primitive;
  primitive["material"] = 0;
  other["material"] = 1;
  writer.json["meshes"] = {{{"primitives", {primitive, other}}}};
  writer.json["nodes"] = {{{"children", {1}}, {"translation", {1, 2, 3}}}, {{"mesh", 0}, {"rotation", {0, 0, 1, 1}}}};
  writer.json["scenes"] = {{{"nodes", {0}}}};
  writer.json["scene"] = 0;
  const int picture = writer.view(png_file(plain_image(2, 2, 9, 8, 7)));
  writer.json["images"] = {{{"uri", "a.png"}}, {{"bufferView", picture}, {"mimeType", "image/png"}}};
  writer.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  for (int i = 0; i < 2; ++i) {
    const nlohmann::json moved = {{"offset", {0.5, 0.25}}, {"rotation", 1.5}, {"scale", {2, 1}}, {"texCoord", 0}};
    const nlohmann::json texture = {{"index", i}, {"extensions", {{"KHR_texture_transform", moved}}}};
    writer.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}});
  }
  return writer.glb();
}

/// Base materials and colours, components, a part of its own.
std::string everything_three_mf() {
  const std::string groups =
      "<basematerials id=\"5\"><base name=\"red\" displaycolor=\"#FF0000\"/></basematerials><m:colorgroup id=\"6\">"
      "<m:color color=\"#00FF00\"/><m:color color=\"#0000FF80\"/></m:colorgroup><m:texture2d id=\"7\" path=\"/t.png\"/>";
  const std::string whole =
      "<object id=\"3\"><components><component objectid=\"1\"/><component objectid=\"1\" p:path=\"/o.model\" "
      "transform=\"-1 0 0 0 1 0 0 0 1 3 0 0\"/></components></object>";
  const std::string resources =
      groups + three_mf_object(1, tetrahedron(), "pid=\"5\" pindex=\"0\"", " pid=\"6\" p1=\"0\" p2=\"1\"") + whole;
  return three_mf_file(three_mf_model(resources, "<item objectid=\"3\"/>\n", "requiredextensions=\"m p\""),
                       {{"o.model", three_mf_model(three_mf_object(1, tetrahedron()), "")}});
}

/// A picture and indices, normals and positions, all compressed.
std::string packed_gltf() {
  GltfWriter writer = gltf_with_meshopt(tetrahedron());
  const int normals = meshopt_view(writer, std::string("\x7f\0\x7f\0\0\x7f\x7f\0\0\0\x7f\0\x81\0\x7f\0", 16), 4, "OCTAHEDRAL");
  writer.json["accessors"].push_back(
      {{"bufferView", normals}, {"componentType", 5120}, {"normalized", true}, {"count", 4}, {"type", "VEC3"}});
  nlohmann::json& primitive = writer.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] = 2;
  primitive["material"] = 0;
  writer.json["images"] = {{{"uri", "a.webp"}}};
  writer.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  writer.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  return writer.glb();
}

}  // namespace

std::vector<MeshSample> mesh_samples() {
  const FileMesh mesh = pyramid();
  const FileMesh triangles = tetrahedron();
  const std::string png = png_file(plain_image(3, 2, 10, 20, 30));
  const std::string jpeg = jpeg_file(plain_image(16, 8, 10, 20, 30));
  return {
      {"ascii.ply", ply_file(mesh, {.format = "ascii"})},
      {"ascii-extras.ply", ply_file(mesh, {.format = "ascii", .extras = true})},
      {"little.ply", ply_file(mesh)},
      {"little-extras.ply", ply_file(mesh, {.count = "int", .index = "ushort", .extras = true})},
      {"big.ply", ply_file(mesh, {.format = "binary_big_endian", .coordinate = "double"})},
      {"strips.ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n"
       "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n8 0 1 2 3 -1 0 1 2\n"},
      {"everything.ply", everything_ply(), {{"a.png", png}}},
      {"mesh.obj", obj_file(mesh) + "f 1/1/1 2//2 \\\n 3/3 -1\n"},
      {"everything.obj",
       "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 9 9 9 9\nvt 0 0\nvt 1 1\nusemtl a\nf 1/1 2/2 3/-1\n"
       "usemtl b\nf 1/1 2/5 3\n",
       {{"a.mtl", "newmtl a\nKd 1 0 0\nmap_Kd -s 1 1 1 a.jpg\nnewmtl b\nKd 0.5\nd 0.5\nmap_Kd a.png\n"},
        {"a.jpg", jpeg},
        {"a.png", png}}},
      {"mesh.off", off_file(mesh)},
      {"everything.off",
       "STCNOFF\n3 2 0\n0 0 0 0 0 1 255 0 0 1 0 0\n1 0 0 0 0 1 1 1 1 0.5 0.5\n0 1 0 0 0 1 1 1 1 1 0 0\n"
       "3 0 1 2 255 0 0\n3 0 2 1 0.5 1 1 1\n"},
      {"mesh.gltf", gltf_tetrahedron().embedded()},
      {"apart.gltf", gltf_tetrahedron().text("a.bin"), {{"a.bin", gltf_tetrahedron().bytes}}},
      {"mesh.glb", gltf_tetrahedron().glb()},
      {"everything.glb", everything_gltf(), {{"a.png", png}}},
      {"draco.glb", gltf_with_draco(triangles, draco_bytes(triangles, std::vector<std::uint8_t>(16, 99)), true).glb()},
      {"draco-in-order.glb", gltf_with_draco(triangles, draco_bytes(triangles, {}, {.sequential = true, .metadata = 9})).glb()},
      {"meshopt.glb", packed_gltf(), {{"a.webp", webp_file(plain_image(3, 2, 10, 20, 30))}}},
      {"meshopt-sequence.glb", gltf_with_meshopt(triangles, false).glb()},
      {"mesh.3mf", three_mf_tetrahedron()},
      {"everything.3mf", everything_three_mf()},
      {"binary.stl", binary_stl_file(triangles)},
      {"solid.stl", binary_stl_file(triangles, "solid")},
      {"text.stl", text_stl_file(triangles)}};
}

}  // namespace curvecast::testing
