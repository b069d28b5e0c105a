// glTF scenes made in memory, for the tests of the reader.
#pragma once

#include <absl/strings/escaping.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/core/mesh_io/mesh_writers.h"

namespace curvecast {

/// A document and the bytes of its only buffer.
class GltfWriter {
 public:
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::string bytes;

  /// A view of `data`; returns its number.
  int view(const std::string& data, int stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size()}};
    if (stride > 0) view["byteStride"] = stride;
    json["bufferViews"].push_back(view);
    bytes += data;
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  /// An accessor over packed numbers; returns its number. `type` such as "VEC3"; `component` as in the format.
  template <class T>
  int accessor(const std::vector<T>& numbers, const char* type, int component, bool normalised = false) {
    std::string data;
    for (const T number : numbers) append(data, number);
    const int components = std::string(type) == "SCALAR" ? 1 : type[3] - '0';
    json["accessors"].push_back({{"bufferView", view(data)},
                                 {"componentType", component},
                                 {"count", numbers.size() / static_cast<std::size_t>(components)},
                                 {"type", type}});
    if (normalised) json["accessors"].back()["normalized"] = true;
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int floats(const std::vector<float>& numbers, const char* type) { return accessor(numbers, type, 5126); }
  /// A mesh of one primitive; returns its number.
  int mesh(const nlohmann::json& primitive) {
    json["meshes"].push_back({{"primitives", {primitive}}});
    return static_cast<int>(json["meshes"].size()) - 1;
  }
  /// Positions and indices of triangles as a primitive.
  nlohmann::json primitive(const FileMesh& from) {
    std::vector<float> places;
    std::vector<std::uint16_t> indices;
    for (const auto& v : from.vertices) {
      for (const double coordinate : v) places.push_back(static_cast<float>(coordinate));
    }
    for (const auto& face : from.faces) indices.insert(indices.end(), face.begin(), face.end());
    return {{"attributes", {{"POSITION", floats(places, "VEC3")}}}, {"indices", accessor(indices, "SCALAR", 5123)}};
  }

  /// As text, the buffer under `uri`.
  std::string text(const std::string& uri) const {
    nlohmann::json whole = json;
    whole["buffers"] = {{{"byteLength", bytes.size()}, {"uri", uri}}};
    return whole.dump(1);
  }
  std::string embedded() const {
    std::string base64;
    absl::Base64Escape(bytes, &base64);
    return text("data:application/octet-stream;base64," + base64);
  }
  std::string glb() const {
    nlohmann::json whole = json;
    whole["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = whole.dump(), data = bytes;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    data.resize((data.size() + 3) / 4 * 4);
    std::string file = "glTF";
    for (const std::size_t word :
         {std::size_t{2}, 12 + 8 + text.size() + 8 + data.size(), text.size(), std::size_t{0x4E4F534A}}) {
      append(file, static_cast<std::uint32_t>(word));
    }
    file += text;
    append(file, static_cast<std::uint32_t>(data.size()));
    append(file, std::uint32_t{0x004E4942});
    return file + data;
  }
};

/// The tetrahedron, as a node.
inline GltfWriter gltf_tetrahedron() {
  GltfWriter writer;
  writer.json["nodes"] = {{{"mesh", writer.mesh(writer.primitive(tetrahedron()))}}};
  return writer;
}

}  // namespace curvecast
