#include <cstdint>
#include <functional>

#include "tests/core/mesh_io/gltf_writer.h"
#include "tests/support/hostile_files.h"

namespace curvecast::testing {
namespace {

using nlohmann::json;

// What the reader's limits on values of JSON (2 million) and on elements (4 million and in proportion) come to.
constexpr std::size_t kModel = 256, kElements = 128;  // MiB

struct Builder {
  std::vector<HostileFile> files;

  /// A GLB of the tetrahedron, its JSON changed.
  void refuse(const char* what, const std::function<void(json&)>& change, const std::string& words) {
    GltfWriter writer = gltf_tetrahedron();
    change(writer.json);
    files.push_back({.what = std::string("glTF with ") + what, .name = "a.glb", .bytes = writer.glb(), .words = {words}});
  }
  void use(const char* what, const std::function<void(json&)>& change, const std::vector<std::string>& words = {}) {
    refuse(what, change, "");
    files.back().usable = true;
    files.back().words = words;
  }
  /// The last one may take more memory than usual: the reader's limit says how much.
  void allow(std::size_t mebibytes) { files.back().memory = mebibytes << 20; }
  void refuse_text(const char* what, const std::string& text, const std::string& words) {
    files.push_back({.what = std::string("glTF ") + what, .name = "a.gltf", .bytes = text, .words = {words}});
  }
};

void add_nodes(Builder& b) {
  b.refuse(
      "nodes that are each other's parents",
      [](json& j) {
        j["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
      },
      "every node is a child of another: nodes are their own ancestors");
  b.refuse(
      "a node that is its own child",
      [](json& j) {
        j["nodes"] = {{{"children", {0}}, {"mesh", 0}}};
        j["scenes"] = {{{"nodes", {0}}}};
        j["scene"] = 0;
      },
      "node 0 is reached twice");
  b.refuse(
      "a scene of a ring of nodes",
      [](json& j) {
        j["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
        j["scenes"] = {{{"nodes", {0}}}};
        j["scene"] = 0;
      },
      "node 0 is reached twice");
  b.refuse(
      "a node of two parents",
      [](json& j) {
        j["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
      },
      "node 1 is reached twice");
  b.refuse(
      "doubling nodes, 50 levels deep",
      [](json& j) {
        j["nodes"] = json::array();
        for (int i = 0; i < 50; ++i) j["nodes"].push_back({{"children", {i + 1, i + 1}}});
        j["nodes"].push_back({{"mesh", 0}});
      },
      "node 1 is reached twice");
  b.use("a chain of 50,000 nodes", [](json& j) {
    j["nodes"] = json::array();
    for (int i = 0; i < 50'000; ++i) j["nodes"].push_back({{"children", {i + 1}}});
    j["nodes"].push_back({{"mesh", 0}});
  });
  b.allow(kModel);
  b.refuse(
      "a child that is not there",
      [](json& j) {
        j["nodes"] = {{{"children", {7}}}};
      },
      "there is no node 7 (the file has 1)");
  b.refuse(
      "a negative child",
      [](json& j) {
        j["nodes"] = {{{"children", {-7}}}};
      },
      "there is no node -7 (the file has 1)");
  b.refuse(
      "a mesh that is not there",
      [](json& j) {
        j["nodes"] = {{{"mesh", 7}}};
      },
      "there is no mesh 7 (the file has 1)");
  b.refuse(
      "a scene that is not there", [](json& j) { j["scene"] = 2; }, "there is no scene 2 (the file has 0)");
  b.refuse(
      "half a matrix",
      [](json& j) {
        j["nodes"][0]["matrix"] = {1, 2, 3};
      },
      "node 0 has a transform of the wrong number of values");
  b.refuse(
      "scales beyond a double",
      [](json& j) {
        j["nodes"][0]["scale"] = {1e300, 1e300, 1e300};
        j["nodes"].push_back({{"children", {0}}, {"scale", {1e300, 1e300, 1e300}}});
      },
      "mesh 0, primitive 0: vertex 0: a coordinate is not a finite number");
  b.refuse(
      "a scale of nothing",
      [](json& j) {
        j["nodes"][0]["scale"] = {0, 0, 0};
      },
      "the mesh has no face with an area");
  b.refuse(
      "4,000 nodes of 1,000 primitives each",
      [](json& j) {
        json primitives = json::array();
        for (int i = 0; i < 1'000; ++i) primitives.push_back(j["meshes"][0]["primitives"][0]);
        j["meshes"][0]["primitives"] = primitives;
        j["nodes"] = json::array();
        for (int i = 0; i < 4'000; ++i) j["nodes"].push_back({{"mesh", 0}});
      },
      "the scene repeats its meshes until it has more than");
  b.allow(kElements);
}

/// Each costs time, and none makes a triangle.
void add_primitives(Builder& b) {
  b.refuse(
      "4,000 nodes of 2,000 primitives without triangles",
      [](json& j) {
        json primitives = json::array();
        for (int i = 0; i < 2'000; ++i) primitives.push_back({{"attributes", json::object()}});
        j["meshes"][0]["primitives"] = primitives;
        j["nodes"] = json::array();
        for (int i = 0; i < 4'000; ++i) j["nodes"].push_back({{"mesh", 0}});
      },
      "the scene repeats its meshes until it has more than");
  b.use("5,000 primitives, most of them without triangles", [](json& j) {
    for (int i = 0; i < 5'000; ++i) j["meshes"][0]["primitives"].push_back({{"attributes", json::object()}});
  });
}

void add_accessors(Builder& b) {
  const auto accessor = [&](const char* what, const char* key, const json& value, const char* words) {
    b.refuse(
        what, [&](json& j) { j["accessors"][0][key] = value; }, words);
  };
  const auto view = [&](const char* what, const char* key, const json& value, const char* words) {
    b.refuse(
        what, [&](json& j) { j["bufferViews"][0][key] = value; }, words);
  };
  accessor("a view that is not there", "bufferView", 9, "mesh 0, primitive 0: accessor 0 (POSITION): there is no buffer view 9");
  accessor("a vertex too many", "count", 5, "accessor 0 (POSITION): 5 elements, 12 bytes apart, at 0 reach beyond buffer view 0");
  accessor("no vertex", "count", 0, "accessor 0 (POSITION): it is empty");
  accessor("-1 vertices", "count", -1, "accessors 0: its count must be a whole number");
  accessor("10^9 vertices", "count", 1'000'000'000, "accessor 0 (POSITION): 1000000000 elements");
  accessor("2^32 vertices", "count", 4'294'967'296, "accessor 0 (POSITION): 4294967296 elements");
  accessor("2^63 - 1 vertices", "count", INT64_MAX, "accessor 0 (POSITION): 9223372036854775807 elements");
  accessor("10^300 vertices", "count", 1e300, "accessors 0: its count must be a whole number");
  accessor("a word for a count", "count", "many", "accessors 0: its count must be a whole number");
  accessor("an offset behind the view", "byteOffset", 40, "reach beyond buffer view 0");
  accessor("an offset of -12", "byteOffset", -12, "accessors 0: its byteOffset must be a whole number");
  accessor("an offset of 2^64 - 12", "byteOffset", UINT64_MAX - 11, "at 18446744073709551604 reach beyond buffer view 0");
  accessor("numbers of an unknown type", "componentType", 5130, "accessor 0 (POSITION): its numbers are of an unknown type");
  accessor("numbers of type -1", "componentType", -1, "accessors 0: its componentType must be a whole number");
  accessor("flat vertices", "type", "VEC2", "accessor 0 (POSITION): it has the wrong number of components");
  accessor("vertices of an unknown kind", "type", "VEC9", "accessors 0: there are no elements of type 'VEC9'");
  view("a view of a megabyte", "byteLength", 1'000'000, "reach beyond buffer 0");
  view("a view of 2^63 - 1 bytes", "byteLength", INT64_MAX, "9223372036854775807 bytes at 0 reach beyond buffer 0");
  view("a view at 2^64 - 5", "byteOffset", UINT64_MAX - 4, "48 bytes at 18446744073709551611 reach beyond buffer 0");
  view("a view at -4", "byteOffset", -4, "bufferViews 0: its byteOffset must be a whole number");
  view("a stride of -12", "byteStride", -12, "bufferViews 0: its byteStride must be a whole number");
  view("a stride of 4", "byteStride", 4, "its elements of 12 bytes overlap: the buffer view's stride is 4");
  view("a stride of 252", "byteStride", 252, "reach beyond buffer view 0");
  view("a stride of 2^63 - 1", "byteStride", INT64_MAX,
       "bufferViews 0: its byteStride is 9223372036854775807; it must be a multiple of 4");
  view("a view of a buffer that is not there", "buffer", 3, "there is no buffer 3 (the file has 1)");
  view("buffer -1", "buffer", -1, "accessor 0 (POSITION): there is no buffer -1");
  b.refuse(
      "an accessor that is not there", [](json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; },
      "mesh 0, primitive 0: there is no accessor 9 (the file has 2)");
  b.refuse(
      "a material that is not there", [](json& j) { j["meshes"][0]["primitives"][0]["material"] = 9; },
      "mesh 0, primitive 0: there is no material 9");
  b.refuse(
      "mode 7", [](json& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }, "mesh 0, primitive 0: there is no mode 7");
  b.refuse(
      "signed indices", [](json& j) { j["accessors"][1]["componentType"] = 5122; }, "accessor 1 holds no indices");
  b.refuse(
      "an index out of range", [](json& j) { j["accessors"][0]["count"] = 3; }, "vertex index 3 is out of range (the file has 3");
  b.refuse(
      "NaNs among the vertices",
      [](json& j) { j["accessors"][0]["byteOffset"] = 0, j["accessors"][0]["bufferView"] = 1, j["accessors"][0]["count"] = 2; },
      "is out of range");
  b.refuse(
      "10^9 sparse vertices",
      [](json& j) {
        j["accessors"][0] = {
            {"componentType", 5126},
            {"type", "VEC3"},
            {"count", 1'000'000'000},
            {"sparse",
             {{"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}}}};
      },
      "accessor 0 (POSITION): sparse accessors claim more elements than are in proportion to the file");
  b.refuse(
      "100,000 sparse vertices",
      [](json& j) {
        j["accessors"][0] = {
            {"componentType", 5126},
            {"type", "VEC3"},
            {"count", 100'000},
            {"sparse",
             {{"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}}}};
      },
      "accessor 0 (POSITION): sparse accessors claim more elements than are in proportion to the file");
  b.refuse(
      "2^31 - 1 sparse values",
      [](json& j) {
        j["accessors"][0]["sparse"] = {
            {"count", INT32_MAX}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}};
      },
      "accessor 0 (POSITION): it replaces more elements than it has");
  b.refuse(
      "a sparse index out of range",
      [](json& j) {
        j["accessors"][0]["sparse"] = {
            {"count", 4}, {"indices", {{"bufferView", 0}, {"componentType", 5125}}}, {"values", {{"bufferView", 0}}}};
      },
      "accessor 0 (POSITION): vertex index 1065353216 is out of range");
}

void add_documents(Builder& b) {
  const std::string start = "{\"asset\":{\"version\":\"2.0\"}";
  const auto repeated = [](const std::string& text, int times) {
    std::string out;
    for (int i = 0; i < times; ++i) out += text;
    return out;
  };
  b.refuse_text("of version 1", "{\"asset\": {\"version\": \"1.0\"}}", "this is not glTF 2.0 (its asset has version '1.0')");
  b.refuse_text("without a colon", "{\"asset\": \n{\"version\" \"2.0\"}}", "line 2: the JSON is malformed");
  b.refuse_text("of nothing", start + "}", "no faces");
  b.refuse_text("cut short", start + ",\n\"meshes\":[", "line 2: the JSON is malformed");
  b.refuse_text("of 100,000 levels", start + ",\"extras\":" + std::string(100'000, '[') + std::string(100'000, ']') + "}",
                "nested deeper than 64 levels");
  b.refuse_text("of 100,000 levels of objects",
                start + ",\"meshes\":" + repeated("{\"a\":", 100'000) + "0" + std::string(100'000, '}') + "}",
                "nested deeper than 64 levels");
  b.refuse_text("of a million open brackets", start + ",\"nodes\":" + std::string(1'000'000, '['),
                "nested deeper than 64 levels");
  b.refuse_text("of three million values", start + ",\"nodes\":[0" + repeated(",0", 3'000'000) + "]}",
                "more than 2000000 values");
  b.allow(kModel);
  b.refuse_text("of 200,000 empty nodes", start + ",\"nodes\":[{}" + repeated(",{}", 200'000) + "]}", "no faces");
  b.allow(kModel);
  b.refuse_text("of 300,000 empty nodes", start + ",\"nodes\":[{}" + repeated(",{}", 300'000) + "]}", "no faces");
  b.allow(kModel);
  b.refuse_text("of 1,900,000 empty nodes", start + ",\"nodes\":[{}" + repeated(",{}", 1'900'000) + "]}", "no faces");
  b.allow(kModel);
  b.refuse_text("of 2,100,000 empty nodes", start + ",\"nodes\":[{}" + repeated(",{}", 2'100'000) + "]}",
                "more than 2000000 values");
  b.allow(kModel);
  b.refuse_text("of 100,000 empty meshes", start + ",\"meshes\":[{}" + repeated(",{}", 100'000) + "]}", "no faces");
  b.allow(kModel);
  b.refuse_text("of 100,000 empty materials", start + ",\"materials\":[{}" + repeated(",{}", 100'000) + "]}", "no faces");
  b.allow(kModel);
  b.refuse_text("with a number of a megabyte", start + ",\"scene\":" + std::string(1'000'000, '9') + "}",
                "line 1: the JSON holds a number out of range");
  b.refuse_text("with a name of two megabytes", start + ",\"nodes\":[{\"name\":\"" + std::string(2'000'000, 'n') + "\"}]}",
                "no faces");
  b.refuse_text("with bytes that are not UTF-8", start + ",\"nodes\":[{\"name\":\"\xff\xfe\"}]}",
                "a.gltf: line 1: the JSON is malformed");
  b.refuse_text("with half of a surrogate", start + ",\"nodes\":[{\"name\":\"\\ud800\"}]}",
                "a.gltf: line 1: the JSON is malformed");
  b.refuse_text("of arrays for objects",
                start + ",\"accessors\":[[]],\"bufferViews\":[[]],\"meshes\":[[]],\"nodes\":[[]],\"scenes\":[[]],\"scene\":[]}",
                "bufferViews 0: it is no JSON object");
  b.refuse_text("of objects for arrays",
                start + ",\"accessors\":{},\"bufferViews\":{},\"meshes\":{},\"nodes\":{},\"buffers\":{},\"images\":{}}",
                "no faces");
  b.refuse_text("of nulls",
                start + ",\"accessors\":null,\"bufferViews\":[null],\"meshes\":[null],\"nodes\":null,\"buffers\":[null]}",
                "bufferViews 0: it is no JSON object");
  b.refuse_text("in UTF-16", std::string("\xff\xfe{\0\"\0a\0", 8), "a.gltf: line 1: the JSON is malformed");
  const GltfWriter writer = gltf_tetrahedron();
  b.refuse_text("with a buffer that is no base64", writer.text("data:application/octet-stream;base64,!!!!"),
                "buffer 0: a data URI is not base64");
  b.refuse_text("with a buffer without data", writer.text("data:,"), "buffer 0: a data URI is not base64");
  b.refuse_text("with a buffer that is too short", writer.text("data:;base64,AAAA"),
                "buffer 0 claims 72 bytes, but there are only 3: it is truncated");
  b.refuse_text("with a buffer that is not there", writer.text("mesh.bin"),
                "buffer 0 is in the file 'mesh.bin', which is not there");
  b.refuse_text("with a buffer that is cut short", writer.text("a.bin"),
                "buffer 0 claims 72 bytes, but there are only 10: it is truncated");
  b.files.back().companions = {{"a.bin", std::string(10, '\0')}};
  b.refuse_text("with a buffer of NaNs", writer.text("a.bin"),
                "mesh 0, primitive 0: vertex 0: a coordinate is not a finite number");
  b.files.back().companions = {{"a.bin", std::string(72, '\xff')}};
  b.refuse_text("that is its own buffer", writer.text("a.gltf"), "mesh 0, primitive 0: vertex index 28781 is out of range");
  b.files.back().companions = {{"a.gltf", writer.text("a.gltf")}};
  for (const char* name : {"KHR_meshopt_compression", "ACME_anything"}) {
    b.refuse((std::string("the extension ") + name).c_str(), [&](json& j) { j["extensionsRequired"] = {name}; },
             std::string("requires the extension ") + name);
  }
}

void add_containers(Builder& b) {
  const std::string whole = gltf_tetrahedron().glb();
  const auto refuse = [&](const std::string& what, std::string bytes, const std::string& words) {
    b.files.push_back({.what = "GLB " + what, .name = "a.glb", .bytes = std::move(bytes), .words = {words}});
  };
  const auto patched = [&](std::size_t at, std::uint32_t word) {
    std::string bytes = whole.substr(0, at);
    append(bytes, word);
    return bytes + whole.substr(at + 4);
  };
  for (const std::size_t part : {0, 3, 8, 15}) {
    const std::size_t length = 4 + (whole.size() - 4) * part / 16;
    refuse("of only " + std::to_string(length) + " bytes", whole.substr(0, length),
           length < 20 ? "the file ends within the header of a GLB" : "it is truncated");
  }
  refuse("of version 3", patched(4, 3), "GLB version 3 is not supported, only 2");
  refuse("of a length of 2^32 - 1", patched(8, UINT32_MAX), "but its header claims 4294967295: it is truncated");
  refuse("with a chunk of 2^32 - 1 bytes", patched(12, UINT32_MAX), "chunk 0 claims 4294967295 bytes, but only ");
  refuse("with a chunk of no bytes", patched(12, 0), "chunk 1 claims 1667310203 bytes, but only 468 are left");
  refuse("without JSON", patched(16, 0), "the first chunk of the GLB is not JSON");
  const std::size_t binary = whole.find(std::string("BIN\0", 4)) - 4;
  refuse("with a second chunk of 2^31 bytes", patched(binary, 1U << 31), "chunk 1 claims 2147483648 bytes, but only 72 are left");
  refuse("with a second chunk of 71 bytes", patched(binary, 71), "buffer 0 claims 72 bytes, but there are only 71");
  refuse("with an unknown second chunk", patched(binary + 4, 7), "buffer 0 has no bytes anywhere");
}

}  // namespace

std::vector<HostileFile> hostile_gltf_files() {
  Builder builder;
  add_nodes(builder);
  add_primitives(builder);
  add_accessors(builder);
  add_documents(builder);
  add_containers(builder);
  return std::move(builder.files);
}

}  // namespace curvecast::testing
