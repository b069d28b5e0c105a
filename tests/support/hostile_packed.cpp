#include <cstdint>
#include <functional>
#include <limits>

#include "tests/core/mesh_io/packed_gltf.h"
#include "tests/support/hostile_files.h"

namespace curvecast::testing {
namespace {

using nlohmann::json;

constexpr char kMeshopt[] = "EXT_meshopt_compression";
constexpr std::size_t kStart = 11;  // of a Draco mesh: the kind of traversal, then the counts

/// As Draco writes a number: seven bits to a byte, the lowest first.
std::string varint(std::uint32_t value) {
  std::string bytes;
  for (; value >= 128; value >>= 7) bytes += static_cast<char>(128 | (value & 127));
  return bytes + static_cast<char>(value);
}

/// A strip of so many steps, four corners and two triangles each.
FileMesh stairs(int steps) {
  FileMesh mesh;
  for (int i = 0; i < steps; ++i) {
    for (int v = 0; v < 4; ++v) mesh.vertices.push_back({i + v / 2 * 1.0, v % 2 * 1.0, i * i % 17 * 1.0});
    mesh.faces.push_back({4 * i, 4 * i + 2, 4 * i + 1});
    mesh.faces.push_back({4 * i + 1, 4 * i + 2, 4 * i + 3});
  }
  return mesh;
}

struct Builder {
  std::vector<HostileFile> files;

  void draco(const std::string& what, const std::string& bytes, const std::string& words,
             const std::function<void(json&)>& change = {}) {
    GltfWriter writer = gltf_with_draco(tetrahedron(), bytes);
    if (change) change(writer.json);
    files.push_back({.what = "Draco " + what, .name = "a.glb", .bytes = writer.glb(), .words = {words}});
  }
  /// The tetrahedron's view of positions changed.
  void meshopt(const std::string& what, const std::function<void(json& extension)>& change, const std::string& words) {
    GltfWriter writer = gltf_with_meshopt(tetrahedron());
    change(writer.json["bufferViews"][0]["extensions"][kMeshopt]);
    files.push_back({.what = "meshopt " + what, .name = "a.glb", .bytes = writer.glb(), .words = {words}});
  }
  void use() {
    files.back().usable = true;
    files.back().words.clear();
  }
};

void claim(json& document, std::uint64_t vertices, std::uint64_t triangles) {
  document["accessors"][0]["count"] = vertices;
  document["accessors"][1]["count"] = 3 * triangles;
}

void add_draco(Builder& b) {
  const std::string whole = draco_bytes(tetrahedron()), sequential = draco_bytes(tetrahedron(), {}, {.sequential = true});
  for (std::size_t length = 0; length + 1 < whole.size(); length += 6) {
    b.draco("cut to " + std::to_string(length) + " bytes", whole.substr(0, length), "buffer view 0: its Draco data is broken");
  }
  b.draco("of another version", std::string(whole).replace(5, 2, "\1\2"), "version 1.2 of the bitstream; glTF wants 2.2");
  b.draco("of a point cloud", std::string(whole).replace(7, 1, 1, '\0'), "its Draco data is no mesh");
  b.draco("of an unknown method", std::string(whole).replace(8, 1, "\7"), "there is no way 7 to encode a mesh");
  b.draco("of metadata that is not there", std::string(whole).replace(10, 1, "\x80"), "buffer view 0: its Draco data ");
  b.draco("of 2^32 - 1 vertices", whole.substr(0, kStart + 1) + varint(UINT32_MAX) + whole.substr(kStart + 2),
          "its Draco data has 4294967295 vertices, but the accessors claim 4");
  const std::string many = whole.substr(0, kStart + 2) + varint(1'000'000'000) + whole.substr(kStart + 3);
  b.draco("of 10^9 triangles", many, "its Draco data has 1000000000 triangles, but the accessors claim 4");
  b.draco("of 10^9 triangles, as the accessors say", many, "claims 1000000000 triangles, more than is in proportion",
          [](json& j) { claim(j, 1'000'000'000, 1'000'000'000); });
  const std::string sixty = whole.substr(0, kStart + 1) + varint(60'000) + varint(60'000) + whole.substr(kStart + 3);
  b.draco("of 60,000 triangles that are not there", sixty, "its Draco data is broken", [](json& j) { claim(j, 60'000, 60'000); });
  b.draco("in order, of 10^9 triangles", sequential.substr(0, kStart) + varint(1'000'000'000) + sequential.substr(kStart + 1),
          "its Draco data has 1000000000 triangles, but the accessors claim 4");
  b.draco("in order, of 60,000 triangles that are not there",
          sequential.substr(0, kStart) + varint(60'000) + varint(60'000) + sequential.substr(kStart + 2),
          "its Draco data is broken", [](json& j) { claim(j, 60'000, 60'000); });
  b.draco("with attributes of 28 bytes", draco_bytes(tetrahedron(), {}, {.extra_floats = 4}), "");
  b.use();
  b.draco("with attributes of 32 bytes", draco_bytes(tetrahedron(), {}, {.extra_floats = 5}),
          "its Draco data has attributes of 32 bytes for each vertex, more than 28");
  b.draco("with metadata of 100,000 bytes", draco_bytes(tetrahedron(), {}, {.metadata = 100'000}),
          "bytes of metadata are too many");
  b.draco("without an accessor of indices", whole, "Draco data needs accessors for positions and indices beside it",
          [](json& j) { j["meshes"][0]["primitives"][0].erase("indices"); });
  b.draco("of accessors that are not there", whole, "Draco data needs accessors for positions and indices beside it",
          [](json& j) { j["meshes"][0]["primitives"][0]["indices"] = 77; });
  const auto extension = [](json& j) -> json& {
    return j["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  };
  b.draco("of a view that is not there", whole, "there is no buffer view 9", [&](json& j) { extension(j)["bufferView"] = 9; });
  b.draco("without a view", whole, "there is no buffer view -1", [&](json& j) { extension(j).erase("bufferView"); });
  b.draco("of an attribute that is not there", whole, "its Draco data has no attribute 5",
          [&](json& j) { extension(j)["attributes"]["POSITION"] = 5; });
  b.draco("of attribute -1", whole, "its Draco data has no attribute -1",
          [&](json& j) { extension(j)["attributes"]["POSITION"] = -1; });
  b.draco("without attributes", whole, "accessor 0 (POSITION): it has no buffer view",
          [&](json& j) { extension(j)["attributes"] = json::object(); });
  b.draco("of positions with four components", whole, "has 3 components, and the accessor 4",
          [](json& j) { j["accessors"][0]["type"] = "VEC4"; });
  b.draco("of NaNs", draco_bytes({{{0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}}, {{0, 1, 2}}}),
          "a coordinate is not a finite number");
  for (const bool small : {true, false}) {
    const FileMesh mesh = small ? tetrahedron() : stairs(2'000);
    GltfWriter writer = gltf_with_draco(mesh, draco_bytes(mesh));
    const json primitive = writer.json["meshes"][0]["primitives"][0], accessor = writer.json["accessors"][0];
    for (int i = 0; i < 2'000; ++i) {
      writer.json["accessors"].push_back(accessor);
      writer.json["meshes"][0]["primitives"].push_back(primitive);
      writer.json["meshes"][0]["primitives"].back()["attributes"]["POSITION"] = 2 + i;
    }
    b.files.push_back({.what = small ? "Draco used 2,000 times" : "much Draco used 2,000 times",
                       .name = "a.glb",
                       .bytes = writer.glb(),
                       .usable = small,
                       .words = {}});
    if (!small) b.files.back().words = {"the same compressed bytes are used over and over"};
  }
}

void add_meshopt(Builder& b) {
  const auto set = [](const char* key, const json& value) { return [=](json& extension) { extension[key] = value; }; };
  b.meshopt("of an unknown mode", set("mode", "VERTICES"), "buffer view 0: there is no meshopt mode 'VERTICES'");
  b.meshopt(
      "without a mode", [](json& e) { e.erase("mode"); }, "there is no meshopt mode ''");
  b.meshopt("of an unknown filter", set("filter", "COLOR"), "there is no meshopt filter 'COLOR' for elements of 12 bytes");
  b.meshopt("of a filter for other elements", set("filter", "QUATERNION"), "there is no meshopt filter 'QUATERNION'");
  b.meshopt("of a stride of 0", set("byteStride", 0), "has a byteStride of 0");
  b.meshopt("of a stride of 13", set("byteStride", 13), "has a byteStride of 13");
  b.meshopt("of a stride of 260", set("byteStride", 260), "has a byteStride of 260");
  b.meshopt("of a stride of 2^63", set("byteStride", std::uint64_t{1} << 63), "has a byteStride of 9223372036854775808");
  b.meshopt(
      "without a count", [](json& e) { e.erase("count"); }, "EXT_meshopt_compression of bufferViews 0: it has no count");
  b.meshopt("of -1 elements", set("count", -1), "its count must be a whole number");
  b.meshopt("of 10^9 elements", set("count", 1'000'000'000), "claims 1000000000 elements of 12 bytes, more than its ");
  b.meshopt("of 2^64 - 1 elements", set("count", UINT64_MAX), "claims 18446744073709551615 elements of 12 bytes");
  b.meshopt("of 200 elements that are not there", set("count", 200), "its meshopt data is broken");
  b.meshopt("of 3 elements", set("count", 3), "4 elements, 12 bytes apart, at 0 reach beyond buffer view 0 of 36 bytes");
  b.meshopt("of no bytes", set("byteLength", 0), "its meshopt data is broken");
  b.meshopt(
      "of a byte less", [](json& e) { e["byteLength"] = e["byteLength"].get<int>() - 1; }, "its meshopt data is broken");
  b.meshopt("of bytes that are not there", set("byteLength", 1'000'000), "reach beyond buffer 0");
  b.meshopt("at 2^64 - 1", set("byteOffset", UINT64_MAX), "reach beyond buffer 0");
  b.meshopt("of a buffer that is not there", set("buffer", 9), "there is no buffer 9");
  b.meshopt(
      "of triangles that are none", [](json& e) { e["mode"] = "TRIANGLES", e["byteStride"] = 4; },
      "its meshopt triangles have 4 corners, no multiple of 3");
  b.meshopt("of triangles of 12 bytes", set("mode", "TRIANGLES"), "has a byteStride of 12");
  b.meshopt(
      "of a sequence that is none", [](json& e) { e["mode"] = "INDICES", e["byteStride"] = 4; }, "its meshopt data is broken");
  b.meshopt(
      "of nothing but zeros", [](json& e) { e["byteOffset"] = 60, e["byteLength"] = 12; }, "its meshopt data is broken");
  // Zeros of 64 elements take 4 bytes for each of theirs, so that little can claim much; not over and over.
  GltfWriter writer = gltf_with_meshopt(tetrahedron());
  writer.json["bufferViews"][0]["extensions"][kMeshopt]["count"] = 4;
  for (int i = 0; i < 4'000; ++i) {
    writer.json["bufferViews"].push_back(writer.json["bufferViews"][0]);
    writer.json["accessors"].push_back(writer.json["accessors"][0]);
    writer.json["accessors"].back()["bufferView"] = 2 + i;
    writer.json["meshes"][0]["primitives"].push_back(writer.json["meshes"][0]["primitives"][0]);
    writer.json["meshes"][0]["primitives"].back()["attributes"]["POSITION"] = 2 + i;
  }
  std::string bytes = writer.glb();
  b.files.push_back({.what = "meshopt used 4,000 times", .name = "a.glb", .bytes = bytes, .usable = true});
  GltfWriter zeros;
  const int view = meshopt_view(zeros, std::string(std::size_t{252} * 40'000, '\0'), 252);
  zeros.json["accessors"] = {{{"bufferView", view}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 40'000}}};
  zeros.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}};
  for (int i = 1; i < 40; ++i) {
    zeros.json["bufferViews"].push_back(zeros.json["bufferViews"][0]);
    zeros.json["accessors"].push_back(zeros.json["accessors"][0]);
    zeros.json["accessors"].back()["bufferView"] = i;
    zeros.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", i}}}});
  }
  b.files.push_back({.what = "meshopt zeros used 40 times",
                     .name = "a.glb",
                     .bytes = zeros.glb(),
                     .memory = std::size_t{96} << 20,
                     .words = {"the same compressed bytes are used over and over"}});
}

}  // namespace

std::vector<HostileFile> hostile_packed_files() {
  Builder builder;
  add_draco(builder);
  add_meshopt(builder);
  return std::move(builder.files);
}

}  // namespace curvecast::testing
