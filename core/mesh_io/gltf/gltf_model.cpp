#include "core/mesh_io/gltf/gltf_model.h"

#include <absl/strings/str_format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "core/base/vec.h"
#include "core/mesh_io/gltf/gltf_json.h"
#include "core/mesh_io/reading/companion_name.h"

namespace curvecast {
namespace {

using Json = nlohmann::json;

/// An element of one of the document's lists. What is wrong with it is kept in the list's status.
class Element {
 public:
  Element(const Json& object, const char* list, std::size_t number, absl::Status& status)
      : object_(object), list_(list), number_(number), status_(status) {}

  const Json& json() const { return object_; }
  std::size_t number() const { return number_; }
  absl::Status& status() { return status_; }
  void fail(std::string_view what) {
    status_.Update(absl::InvalidArgumentError(absl::StrFormat("%s %d: %s", list_, number_, what)));
  }

  /// A number of bytes or elements. What is not there is 0.
  std::uint64_t count(const char* key) {
    const Json* const value = gltf_member(object_, key);
    if (value == nullptr) return 0;
    if (value->is_number_unsigned()) return value->get<std::uint64_t>();
    fail(absl::StrFormat("its %s must be a whole number, not negative and below 2^64", key));
    return 0;
  }
  std::uint64_t required_count(const char* key) {
    require(object_, key);
    return count(key);
  }
  void require(const Json& object, const char* key) {
    if (gltf_member(object, key) == nullptr) fail(absl::StrFormat("it has no %s", key));
  }

 private:
  const Json& object_;
  const char* list_;
  std::size_t number_;
  absl::Status& status_;
};

/// Makes an entry of `out` from every element of a list, if there is one.
template <typename T, typename Read>
absl::Status read_list(const Json& document, const char* list, std::vector<T>& out, const Read& read) {
  const Json* const elements = gltf_member(document, list);
  if (elements == nullptr || !elements->is_array()) return absl::OkStatus();
  out.reserve(elements->size());
  for (const Json& object : *elements) {
    absl::Status status;
    Element element(object, list, out.size(), status);
    if (!object.is_object()) element.fail("it is no JSON object");
    if (status.ok()) out.push_back(read(element));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

/// Up to the first value that is none.
std::vector<std::int64_t> indices_of(const Json& object, const char* key) {
  std::vector<std::int64_t> indices;
  const Json* const values = gltf_member(object, key);
  if (values == nullptr || !values->is_array()) return indices;
  indices.reserve(values->size());
  for (const Json& value : *values) {
    if (!value.is_number_integer()) break;
    indices.push_back(value.get<std::int64_t>());
  }
  return indices;
}

/// Up to the first value that is none.
std::vector<double> numbers_of(const Json& object, const char* key) {
  std::vector<double> numbers;
  const Json* const values = gltf_member(object, key);
  if (values == nullptr || !values->is_array()) return numbers;
  numbers.reserve(values->size());
  for (const Json& value : *values) {
    if (!value.is_number()) break;
    numbers.push_back(value.get<double>());
  }
  return numbers;
}

/// A component type that there is not stays one.
GltfComponent component_of(std::uint64_t number) { return static_cast<GltfComponent>(number < 10'000 ? number : 0); }

/// The extension of this name on an object; null where there is none.
const Json* extension_of(const Json& object, const char* name) {
  const Json* const extensions = gltf_member(object, "extensions");
  const Json* const extension = extensions != nullptr ? gltf_member(*extensions, name) : nullptr;
  return extension != nullptr && extension->is_object() ? extension : nullptr;
}

/// Indices by their names; what is no whole number is left out.
std::map<std::string, std::int64_t> named_indices(const Json& object, const char* key) {
  std::map<std::string, std::int64_t> indices;
  const Json* const values = gltf_member(object, key);
  if (values == nullptr || !values->is_object()) return indices;
  for (const auto& [name, value] : values->items()) {
    if (value.is_number_integer()) indices[name] = value.get<std::int64_t>();
  }
  return indices;
}

std::unique_ptr<const GltfMeshopt> read_meshopt(const Json& view, std::size_t number, absl::Status& status) {
  const Json* const extension = extension_of(view, "EXT_meshopt_compression");
  if (extension == nullptr) return nullptr;
  Element element(*extension, "EXT_meshopt_compression of bufferViews", number, status);
  element.require(*extension, "buffer");
  GltfMeshopt meshopt{.buffer = gltf_number(*extension, "buffer"),
                      .offset = element.count("byteOffset"),
                      .length = element.required_count("byteLength"),
                      .stride = element.required_count("byteStride"),
                      .count = element.required_count("count"),
                      .mode = gltf_string(*extension, "mode"),
                      .filter = gltf_string(*extension, "filter")};
  if (meshopt.filter == "NONE") meshopt.filter.clear();
  return std::make_unique<const GltfMeshopt>(std::move(meshopt));
}

GltfView read_view(Element& element) {
  constexpr std::uint64_t kMostStride = 252;
  element.require(element.json(), "buffer");
  GltfView view{.buffer = gltf_number(element.json(), "buffer"),
                .offset = element.count("byteOffset"),
                .length = element.required_count("byteLength"),
                .stride = element.count("byteStride"),
                .meshopt = read_meshopt(element.json(), element.number(), element.status())};
  if (view.stride > kMostStride || view.stride % 4 != 0) {
    element.fail(absl::StrFormat("its byteStride is %d; it must be a multiple of 4, %d at most", view.stride, kMostStride));
  }
  return view;
}

/// 0 where there is no such type of element.
int components_of(std::string_view type) {
  constexpr std::pair<std::string_view, int> kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                         {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
  for (const auto& [name, components] : kTypes) {
    if (name == type) return components;
  }
  return 0;
}

void read_sparse(const Json& sparse, Element& element, GltfClaim& claim) {
  const Json* const indices = gltf_member(sparse, "indices");
  const Json* const values = gltf_member(sparse, "values");
  if (indices == nullptr || values == nullptr || gltf_member(*indices, "bufferView") == nullptr ||
      gltf_member(*indices, "componentType") == nullptr || gltf_member(*values, "bufferView") == nullptr ||
      gltf_member(sparse, "count") == nullptr) {
    element.fail("its sparse part lacks count, indices or values");
    return;
  }
  const auto unsigned_of = [](const Json& object, const char* key, std::uint64_t otherwise) {
    const Json* const value = gltf_member(object, key);
    return value != nullptr && value->is_number_unsigned() ? value->get<std::uint64_t>() : otherwise;
  };
  const auto offset_of = [&](const Json& object) {
    return gltf_member(object, "byteOffset") == nullptr ? 0 : unsigned_of(object, "byteOffset", UINT64_MAX);
  };
  claim.replaced = unsigned_of(sparse, "count", 0);
  claim.indices = {.view = gltf_number(*indices, "bufferView"),
                   .offset = offset_of(*indices),
                   .component = component_of(unsigned_of(*indices, "componentType", 0))};
  claim.values = {.view = gltf_number(*values, "bufferView"), .offset = offset_of(*values), .component = claim.region.component};
}

GltfClaim read_accessor(Element& element) {
  GltfClaim claim;
  claim.region = {.view = gltf_number(element.json(), "bufferView"),
                  .offset = element.count("byteOffset"),
                  .component = component_of(element.required_count("componentType"))};
  claim.count = element.required_count("count");
  const std::string type = gltf_string(element.json(), "type");
  claim.components = components_of(type);
  if (claim.components == 0) element.fail(absl::StrFormat("there are no elements of type '%s'", display_name(type)));
  const Json* const normalised = gltf_member(element.json(), "normalized");
  claim.normalised = normalised != nullptr && normalised->is_boolean() && normalised->get<bool>();
  if (const Json* const sparse = gltf_member(element.json(), "sparse")) read_sparse(*sparse, element, claim);
  return claim;
}

/// Primitives without attributes, which nothing could be made of, are left out.
std::vector<GltfPrimitive> read_mesh(Element& element) {
  std::vector<GltfPrimitive> primitives;
  const Json* const list = gltf_member(element.json(), "primitives");
  for (std::size_t i = 0; list != nullptr && list->is_array() && i < list->size(); ++i) {
    const Json& from = (*list)[i];
    const Json* const attributes = gltf_member(from, "attributes");
    if (attributes == nullptr || !attributes->is_object()) continue;
    GltfPrimitive& to = primitives.emplace_back();
    to.number = i;
    if (const std::int64_t mode = gltf_number(from, "mode"); mode >= 0) to.mode = mode;
    to.indices = gltf_number(from, "indices");
    to.material = gltf_number(from, "material");
    to.attributes = named_indices(from, "attributes");
    if (const Json* const draco = extension_of(from, "KHR_draco_mesh_compression")) {
      to.draco = std::make_unique<const GltfDraco>(
          GltfDraco{.view = gltf_number(*draco, "bufferView"), .attributes = named_indices(*draco, "attributes")});
    }
  }
  return primitives;
}

GltfNode read_node(Element& element) {
  GltfNode node{.mesh = gltf_number(element.json(), "mesh"), .children = indices_of(element.json(), "children"), .transform = {}};
  GltfTransform transform{.matrix = numbers_of(element.json(), "matrix"),
                          .translation = numbers_of(element.json(), "translation"),
                          .rotation = numbers_of(element.json(), "rotation"),
                          .scale = numbers_of(element.json(), "scale")};
  const auto& [matrix, translation, rotation, scale] = transform;
  if (!matrix.empty() || !translation.empty() || !rotation.empty() || !scale.empty()) {
    node.transform = std::make_unique<const GltfTransform>(std::move(transform));
  }
  return node;
}

/// The extension KHR_texture_transform: scaled, turned clockwise (v grows downwards), moved.
Eigen::Affine2d texture_transform(const Json& extension) {
  const auto number = [](const Json* value) { return value != nullptr && value->is_number() ? value->get<double>() : 0.0; };
  const auto pair = [&](const char* key, const Vec2d& otherwise) {
    const Json* const value = gltf_member(extension, key);
    const bool is_pair = value != nullptr && value->is_array() && value->size() == 2;
    return is_pair ? Vec2d(number(&(*value)[0]), number(&(*value)[1])) : otherwise;
  };
  const double angle = number(gltf_member(extension, "rotation"));
  Eigen::Matrix2d turn;
  turn << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
  Eigen::Affine2d frame = Eigen::Affine2d::Identity();
  frame.translate(pair("offset", Vec2d::Zero())).rotate(turn).scale(pair("scale", Vec2d::Ones()));
  return frame;
}

GltfTextureUse read_texture_use(const Json& info) {
  GltfTextureUse use{.texture = gltf_number(info, "index"), .set = std::max<std::int64_t>(0, gltf_number(info, "texCoord"))};
  const Json* const moved = extension_of(info, "KHR_texture_transform");
  if (moved == nullptr) return use;
  use.frame = texture_transform(*moved);
  if (const std::int64_t own = gltf_number(*moved, "texCoord"); own >= 0) use.set = own;
  return use;
}

GltfMaterial read_material(Element& element) {
  GltfMaterial material{.name = gltf_string(element.json(), "name"), .colour = {}, .colour_texture = {}};
  const Json* const look = gltf_member(element.json(), "pbrMetallicRoughness");
  if (look == nullptr) return material;
  material.colour = numbers_of(*look, "baseColorFactor");
  if (material.colour.size() != 4) material.colour.clear();
  const Json* const info = gltf_member(*look, "baseColorTexture");
  if (info != nullptr && gltf_number(*info, "index") >= 0) {
    material.colour_texture = std::make_unique<const GltfTextureUse>(read_texture_use(*info));
  }
  return material;
}

}  // namespace

absl::StatusOr<GltfModel> read_gltf_model(const Json& document) {
  GltfModel model;
  if (const Json* const names = gltf_member(document, "extensionsRequired"); names != nullptr && names->is_array()) {
    for (const Json& name : *names) model.required_extensions.push_back(name.is_string() ? name.get<std::string>() : "");
  }
  absl::Status status = read_list(document, "bufferViews", model.views, read_view);
  status.Update(read_list(document, "accessors", model.accessors, read_accessor));
  status.Update(read_list(document, "meshes", model.meshes, read_mesh));
  status.Update(read_list(document, "nodes", model.nodes, read_node));
  const auto read_scene = [](Element& element) { return indices_of(element.json(), "nodes"); };
  status.Update(read_list(document, "scenes", model.scenes, read_scene));
  status.Update(read_list(document, "materials", model.materials, read_material));
  const auto read_texture = [](Element& element) {
    const Json* const webp = extension_of(element.json(), "EXT_texture_webp");
    const std::int64_t image = webp != nullptr ? gltf_number(*webp, "source") : -1;
    return image >= 0 ? image : gltf_number(element.json(), "source");
  };
  status.Update(read_list(document, "textures", model.image_of_texture, read_texture));
  if (!status.ok()) return status;
  model.scene = gltf_number(document, "scene");
  return model;
}

}  // namespace curvecast
