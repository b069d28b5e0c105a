#include "tests/core/mesh_io/packed_gltf.h"

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>

#include <array>
#include <memory>

namespace curvecast {
namespace {

template <class T>
void add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data, int components,
                   const std::vector<T>& values) {
  const auto size = static_cast<std::size_t>(components);
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<std::int8_t>(components), data, type == draco::GeometryAttribute::COLOR,
                 static_cast<std::int64_t>(sizeof(T) * size), 0);
  const auto count = static_cast<std::uint32_t>(values.size() / size);
  const int id = mesh.AddAttribute(attribute, true, count);
  for (std::uint32_t v = 0; v < count; ++v)
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), &values[v * size]);
}

std::vector<float> floats_of(const FileMesh& mesh) {
  std::vector<float> floats;
  for (const auto& v : mesh.vertices) {
    for (const double coordinate : v) floats.push_back(static_cast<float>(coordinate));
  }
  return floats;
}

std::vector<unsigned int> indices_of(const FileMesh& mesh) {
  std::vector<unsigned int> indices;
  for (const auto& face : mesh.faces) indices.insert(indices.end(), face.begin(), face.end());
  return indices;
}

/// A view of compressed bytes; returns its number. The buffer of what they stand for is not there.
int packed_view(GltfWriter& writer, const std::vector<unsigned char>& packed, std::size_t count, int stride, const char* mode) {
  const int holder = writer.view(std::string(packed.begin(), packed.end()));
  nlohmann::json& view = writer.json["bufferViews"].back();
  const nlohmann::json offset = view["byteOffset"];
  view = {{"buffer", 1},
          {"byteLength", count * static_cast<std::size_t>(stride)},
          {"extensions",
           {{"EXT_meshopt_compression",
             {{"buffer", 0},
              {"byteOffset", offset},
              {"byteLength", packed.size()},
              {"byteStride", stride},
              {"count", count},
              {"mode", mode}}}}}};
  if (std::string(mode) == "ATTRIBUTES") view["byteStride"] = stride;
  return holder;
}

}  // namespace

std::string draco_bytes(const FileMesh& mesh, const std::vector<std::uint8_t>& colours, const DracoStyle& style) {
  draco::Mesh to;
  to.set_num_points(static_cast<std::uint32_t>(mesh.vertices.size()));
  add_attribute(to, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, floats_of(mesh));
  if (!colours.empty()) add_attribute(to, draco::GeometryAttribute::COLOR, draco::DT_UINT8, 4, colours);
  if (style.extra_floats > 0) {
    const std::vector<float> values(mesh.vertices.size() * static_cast<std::size_t>(style.extra_floats), 1);
    add_attribute(to, draco::GeometryAttribute::GENERIC, draco::DT_FLOAT32, style.extra_floats, values);
  }
  to.SetNumFaces(mesh.faces.size());
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    draco::Mesh::Face face;
    for (std::size_t i = 0; i < 3; ++i) face[i] = draco::PointIndex(static_cast<std::uint32_t>(mesh.faces[f][i]));
    to.SetFace(draco::FaceIndex(f), face);
  }
  if (style.metadata > 0) {
    auto metadata = std::make_unique<draco::GeometryMetadata>();
    metadata->AddEntryString("name", std::string(static_cast<std::size_t>(style.metadata), 'm'));
    auto child = std::make_unique<draco::Metadata>();
    child->AddEntryInt("number", 7);
    metadata->AddSubMetadata("child", std::move(child));
    to.AddMetadata(std::move(metadata));
  }
  draco::ExpertEncoder encoder(to);
  encoder.SetEncodingMethod(style.sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer buffer;
  return encoder.EncodeToBuffer(&buffer).ok() ? std::string(buffer.data(), buffer.size()) : std::string();
}

GltfWriter gltf_with_draco(const FileMesh& mesh, const std::string& draco, bool coloured) {
  GltfWriter writer;
  const auto add = [&](std::size_t count, const char* type, int component) {
    writer.json["accessors"].push_back({{"componentType", component}, {"count", count}, {"type", type}});
    return static_cast<int>(writer.json["accessors"].size()) - 1;
  };
  nlohmann::json primitive = {{"attributes", {{"POSITION", add(mesh.vertices.size(), "VEC3", 5126)}}},
                              {"indices", add(3 * mesh.faces.size(), "SCALAR", 5123)}};
  nlohmann::json ids = {{"POSITION", 0}};
  if (coloured) {
    primitive["attributes"]["COLOR_0"] = add(mesh.vertices.size(), "VEC4", 5121);
    writer.json["accessors"].back()["normalized"] = true;
    ids["COLOR_0"] = 1;
  }
  const int view = writer.view(draco);
  primitive["extensions"] = {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", ids}}}};
  writer.json["nodes"] = {{{"mesh", writer.mesh(primitive)}}};
  writer.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return writer;
}

int meshopt_view(GltfWriter& writer, const std::string& elements, int stride, const char* filter) {
  const auto size = static_cast<std::size_t>(stride);
  const std::size_t count = elements.size() / size;
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(count, size));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), elements.data(), count, size));
  const int view = packed_view(writer, packed, count, stride, "ATTRIBUTES");
  if (filter != nullptr) writer.json["bufferViews"].back()["extensions"]["EXT_meshopt_compression"]["filter"] = filter;
  return view;
}

GltfWriter gltf_with_meshopt(const FileMesh& mesh, bool as_triangles) {
  GltfWriter writer;
  std::string elements;
  for (const float coordinate : floats_of(mesh)) append(elements, coordinate);
  const int places = meshopt_view(writer, elements, 12);
  const std::vector<unsigned int> indices = indices_of(mesh);
  std::vector<unsigned char> packed;
  if (as_triangles) {
    packed.resize(meshopt_encodeIndexBufferBound(indices.size(), mesh.vertices.size()));
    packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), indices.size()));
  } else {
    packed.resize(meshopt_encodeIndexSequenceBound(indices.size(), mesh.vertices.size()));
    packed.resize(meshopt_encodeIndexSequence(packed.data(), packed.size(), indices.data(), indices.size()));
  }
  const int corners = packed_view(writer, packed, indices.size(), 2, as_triangles ? "TRIANGLES" : "INDICES");
  const auto accessor = [&](int view, const char* type, int component, std::size_t count) {
    writer.json["accessors"].push_back({{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
    return static_cast<int>(writer.json["accessors"].size()) - 1;
  };
  const int position = accessor(places, "VEC3", 5126, mesh.vertices.size());
  writer.mesh({{"attributes", {{"POSITION", position}}}, {"indices", accessor(corners, "SCALAR", 5123, indices.size())}});
  writer.json["nodes"] = {{{"mesh", 0}}};
  writer.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  return writer;
}

}  // namespace curvecast
