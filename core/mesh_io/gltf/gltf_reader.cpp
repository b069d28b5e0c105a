#include "core/mesh_io/gltf/gltf_reader.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/colour.h"
#include "core/base/srgb.h"
#include "core/mesh/own_crease_angle.h"
#include "core/mesh_io/gltf/gltf_accessor.h"
#include "core/mesh_io/gltf/gltf_document.h"
#include "core/mesh_io/gltf/gltf_nodes.h"
#include "core/mesh_io/reading/companion_name.h"
#include "core/mesh_io/reading/mesh_reading.h"
#include "core/mesh_io/reading/texture_loader.h"

namespace curvecast {
namespace {

template <class T>
bool has(const std::vector<T>& items, std::int64_t index) {
  return index >= 0 && index < static_cast<std::int64_t>(items.size());
}

/// Texture coordinates and how the material moves them.
struct TextureCoordinates {
  GltfAccessor coordinates;
  Eigen::Affine2d frame;
};

/// Extensions that change where triangles are cannot be passed over; those that change looks can.
absl::Status check_extensions(const GltfModel& model, std::vector<std::string>& warnings) {
  constexpr std::string_view kRead[] = {"KHR_mesh_quantization", "KHR_texture_transform", "KHR_draco_mesh_compression",
                                        "EXT_meshopt_compression", "EXT_texture_webp"};
  for (const std::string& name : model.required_extensions) {
    if (std::find(std::begin(kRead), std::end(kRead), name) != std::end(kRead)) continue;
    const bool looks_only = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") ||
                            name.starts_with("EXT_texture_") || name.starts_with("KHR_lights_");
    if (!looks_only) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the file requires the extension %s, which is not supported; export it without", display_name(name)));
    }
    add_warning(warnings, absl::StrFormat("The extension %s, which the file requires, is ignored.", display_name(name)));
  }
  return absl::OkStatus();
}

class GltfReader {
 public:
  GltfReader(const MeshFile& file, const ExecutionContext& context, const GltfDocument& document)
      : document_(document),
        model_(document.model),
        accessors_(file, document),
        textures_(file, soup_.warnings),
        context_(context) {
    soup_.shares_vertices = false;
    soup_.polygon_begin.push_back(0);
  }

  absl::StatusOr<PolygonSoup> read() {
    if (absl::Status status = check_extensions(model_, soup_.warnings); !status.ok()) return status;
    if (absl::Status status = read_scene(); !status.ok()) return status;
    MeshAttributes& attributes = soup_.attributes;
    if (!attributes.colours.empty()) attributes.colours.resize(soup_.positions.size());
    if (!attributes.normals.empty()) attributes.normals.resize(soup_.positions.size(), Vec3f::Zero());
    if (!attributes.uv.empty()) attributes.uv.resize(soup_.indices.size(), Vec2f::Zero());
    soup_.crease_degrees = own_crease_angle(soup_, {.normals = attributes.normals,
                                                    .normal_of_corner = soup_.indices,
                                                    .group_of_polygon = {},
                                                    .is_quantised = is_quantised_});
    if (!attributes.material_of_face.empty()) read_materials();
    return std::move(soup_);
  }

 private:
  absl::Status read_scene() {
    std::vector<std::int64_t> roots;
    const std::vector<GltfNode>& nodes = model_.nodes;
    if (model_.scene >= 0) {
      if (!has(model_.scenes, model_.scene)) return gltf_has_no("scene", model_.scene, model_.scenes.size());
      roots = model_.scenes[static_cast<std::size_t>(model_.scene)];
    } else if (absl::StatusOr<std::vector<std::int64_t>> found = gltf_roots(nodes); found.ok()) {
      roots = *std::move(found);
    } else {
      return found.status();
    }
    absl::StatusOr<std::vector<GltfInstance>> instances = gltf_instances(nodes, roots);
    if (!instances.ok()) return instances.status();
    for (std::size_t mesh = 0; nodes.empty() && mesh < model_.meshes.size(); ++mesh) {
      instances->push_back({static_cast<std::int64_t>(mesh), Eigen::Affine3d::Identity()});
    }
    monitor_.emplace(context_, std::max<std::size_t>(1, instances->size()));
    for (const GltfInstance& instance : *instances) {
      if (absl::Status status = read_instance(instance); !status.ok()) return status;
      if (!monitor_->tick(++instances_done_)) return monitor_->status();
    }
    return absl::OkStatus();
  }

  // ------------------------------------------------------------------------------------------------------------ primitives

  absl::Status read_instance(const GltfInstance& instance) {
    if (!has(model_.meshes, instance.mesh)) return gltf_has_no("mesh", instance.mesh, model_.meshes.size());
    blocks_.clear();
    for (const GltfPrimitive& primitive : model_.meshes[static_cast<std::size_t>(instance.mesh)]) {
      absl::Status status = check_room(++primitives_done_, "primitives");
      if (status.ok()) status = read_primitive(primitive, instance.world);
      if (status.ok()) continue;
      if (absl::IsCancelled(status)) return status;
      return absl::Status(status.code(),
                          absl::StrFormat("mesh %d, primitive %d: %s", instance.mesh, primitive.number, status.message()));
    }
    return absl::OkStatus();
  }

  static std::int64_t attribute_of(const GltfPrimitive& primitive, const std::string& name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
  }

  absl::Status read_primitive(const GltfPrimitive& primitive, const Eigen::Affine3d& world) {
    if (primitive.mode < GltfPrimitive::kTriangles) return absl::OkStatus();  // points and lines
    if (primitive.mode > GltfPrimitive::kTriangleFan) {
      return absl::InvalidArgumentError(absl::StrFormat("there is no mode %d", primitive.mode));
    }
    const std::int64_t position = attribute_of(primitive, "POSITION");
    if (position < 0) return absl::OkStatus();  // the format lets extensions supply it
    if (absl::Status status = accessors_.unpack(primitive); !status.ok()) return status;
    const absl::StatusOr<GltfAccessor> positions = accessors_.find(primitive, position, 3, 3, "POSITION");
    if (!positions.ok()) return positions.status();
    const absl::StatusOr<std::size_t> first = read_vertices(primitive, *positions, world);
    if (!first.ok()) return first.status();

    std::optional<GltfAccessor> indices;
    if (primitive.indices >= 0) {
      const absl::StatusOr<GltfAccessor> found = accessors_.find(primitive, primitive.indices, 1, 1, "the indices");
      if (!found.ok()) return found.status();
      if (!found->is_index())
        return absl::InvalidArgumentError(absl::StrFormat("accessor %d holds no indices", primitive.indices));
      indices = *found;
    }
    return read_triangles(primitive, *first, positions->count, indices, world.linear().determinant() < 0);
  }

  // The number of the first vertex. Primitives of a mesh often share their vertices and differ in material only.
  absl::StatusOr<std::size_t> read_vertices(const GltfPrimitive& primitive, const GltfAccessor& positions,
                                            const Eigen::Affine3d& world) {
    const std::array<std::int64_t, 4> key = {attribute_of(primitive, "POSITION"), attribute_of(primitive, "NORMAL"),
                                             attribute_of(primitive, "COLOR_0"),
                                             primitive.draco != nullptr ? primitive.draco->view : -1};
    const auto [known, is_new] = blocks_.try_emplace(key, soup_.positions.size());
    if (!is_new) return known->second;
    const std::size_t first = soup_.positions.size();
    if (absl::Status status = check_room(first + positions.count, "vertices"); !status.ok()) return status;
    grow(soup_.positions, first + positions.count);
    for (std::size_t i = 0; i < positions.count; ++i) {
      if (!monitor_->tick(instances_done_)) return monitor_->status();
      const Vec3d p = world * Vec3d(positions.number(i, 0), positions.number(i, 1), positions.number(i, 2));
      if (!is_finite(p)) return absl::InvalidArgumentError(absl::StrFormat("vertex %d: %s", i, kNotFinite));
      soup_.positions.push_back(p);
    }
    MeshAttributes& attributes = soup_.attributes;
    if (key[1] >= 0) {
      const absl::StatusOr<GltfAccessor> normals = accessors_.find(primitive, key[1], 3, 3, "NORMAL");
      if (!normals.ok()) return normals.status();
      is_quantised_ = is_quantised_ || normals->component != GltfComponent::kFloat || accessors_.has_decoded();
      const Eigen::Matrix3d turn = world.linear().inverse().transpose();
      attributes.normals.resize(first, Vec3f::Zero());
      for (std::size_t i = 0; i < std::min(positions.count, normals->count); ++i) {
        const Vec3d n = turn * Vec3d(normals->number(i, 0), normals->number(i, 1), normals->number(i, 2));
        attributes.normals.emplace_back(n.normalized().cast<float>());
      }
      attributes.normals.resize(soup_.positions.size(), Vec3f::Zero());
    }
    if (key[2] >= 0) {
      const absl::StatusOr<GltfAccessor> colours = accessors_.find(primitive, key[2], 3, 4, "COLOR_0");
      if (!colours.ok()) return colours.status();
      const auto encoded = [&](std::size_t i, int c) { return srgb_byte(colours->number(i, c)); };
      attributes.colours.resize(first);
      for (std::size_t i = 0; i < std::min(positions.count, colours->count); ++i) {
        const std::uint8_t alpha = colours->components == 4 ? unit_to_byte(colours->number(i, 3)) : std::uint8_t{255};
        attributes.colours.push_back({encoded(i, 0), encoded(i, 1), encoded(i, 2), alpha});
      }
      attributes.colours.resize(soup_.positions.size());
    }
    return first;
  }

  absl::Status read_triangles(const GltfPrimitive& primitive, std::size_t first, std::size_t vertices,
                              const std::optional<GltfAccessor>& indices, bool mirrored) {
    // Draco turns strips into triangles of their own.
    const std::int64_t mode = primitive.draco != nullptr ? GltfPrimitive::kTriangles : primitive.mode;
    const std::size_t count = indices ? indices->count : vertices;
    const std::size_t triangles = mode == GltfPrimitive::kTriangles ? count / 3 : count < 3 ? 0 : count - 2;
    if (absl::Status status = check_room(soup_.indices.size() / 3 + triangles, "triangles"); !status.ok()) return status;
    const absl::StatusOr<std::optional<TextureCoordinates>> uv = uv_of(primitive);
    if (!uv.ok()) return uv.status();
    MeshAttributes& attributes = soup_.attributes;
    const std::size_t old_size = soup_.indices.size();
    grow(soup_.indices, old_size + 3 * triangles);
    if (*uv) attributes.uv.resize(old_size, Vec2f::Zero());
    for (std::size_t t = 0; t < triangles; ++t) {
      if (!monitor_->tick(instances_done_)) return monitor_->status();
      std::array<std::size_t, 3> corners = {3 * t, 3 * t + 1, 3 * t + 2};
      if (mode == GltfPrimitive::kTriangleStrip) corners = {t, t + 1 + t % 2, t + 2 - t % 2};
      if (mode == GltfPrimitive::kTriangleFan) corners = {0, t + 1, t + 2};
      if (mirrored) std::swap(corners[1], corners[2]);
      for (const std::size_t corner : corners) {
        const std::size_t vertex = indices ? indices->index(corner) : corner;
        if (vertex >= vertices)
          return absl::InvalidArgumentError(index_out_of_range(static_cast<std::int64_t>(vertex), vertices));
        soup_.indices.push_back(static_cast<std::uint32_t>(first + vertex));
        if (*uv) attributes.uv.push_back(place(**uv, vertex));
      }
      soup_.polygon_begin.push_back(static_cast<std::uint32_t>(soup_.indices.size()));
    }
    if (primitive.material >= 0 && !has(model_.materials, primitive.material)) {
      return gltf_has_no("material", primitive.material, model_.materials.size());
    }
    if (!model_.materials.empty()) {
      attributes.material_of_face.resize(soup_.polygon_count(), primitive.material < 0
                                                                    ? MeshAttributes::kNoMaterial
                                                                    : static_cast<std::uint32_t>(primitive.material));
    }
    return absl::OkStatus();
  }

  // Pictures of glTF have v downwards. Vertices without texture coordinates, which there should be none of, are at 0 0.
  static Vec2f place(const TextureCoordinates& uv, std::size_t vertex) {
    if (vertex >= uv.coordinates.count) return Vec2f::Zero();
    const Vec2d p = uv.frame * Vec2d(uv.coordinates.number(vertex, 0), uv.coordinates.number(vertex, 1));
    return Vec2d(p.x(), 1 - p.y()).cast<float>();
  }

  // The texture coordinates that the base colour's texture asks for.
  absl::StatusOr<std::optional<TextureCoordinates>> uv_of(const GltfPrimitive& primitive) {
    const GltfTextureUse plain;
    const GltfTextureUse* use = &plain;
    if (has(model_.materials, primitive.material)) {
      const GltfMaterial& material = model_.materials[static_cast<std::size_t>(primitive.material)];
      if (material.colour_texture != nullptr) use = material.colour_texture.get();
    }
    const std::int64_t index = attribute_of(primitive, absl::StrFormat("TEXCOORD_%d", use->set));
    if (index < 0) return std::optional<TextureCoordinates>();
    const absl::StatusOr<GltfAccessor> found = accessors_.find(primitive, index, 2, 2, "texture coordinates");
    if (!found.ok()) return found.status();
    return std::optional(TextureCoordinates{*found, use->frame});
  }

  // ------------------------------------------------------------------------------------------------------------- materials

  void read_materials() {
    std::map<std::int64_t, std::shared_ptr<const Image>> images;
    for (std::size_t i = 0; i < model_.materials.size(); ++i) {
      const GltfMaterial& from = model_.materials[i];
      Material& to = soup_.attributes.materials.emplace_back();
      to.name = display_name(from.name);
      if (const std::vector<double>& c = from.colour; !c.empty()) {
        to.colour = {srgb_byte(c[0]), srgb_byte(c[1]), srgb_byte(c[2]), unit_to_byte(c[3])};
      }
      if (from.colour_texture == nullptr) continue;
      const std::int64_t texture = from.colour_texture->texture;
      const bool is_there = has(model_.image_of_texture, texture);
      const std::int64_t image = is_there ? model_.image_of_texture[static_cast<std::size_t>(texture)] : -1;
      const auto [known, is_new] = images.try_emplace(image);
      if (is_new) known->second = load_image(image, absl::StrFormat("material %d", i));
      to.texture = known->second;
    }
  }

  std::shared_ptr<const Image> load_image(std::int64_t index, const std::string& where) {
    const std::string name = absl::StrFormat("image %d", index);
    absl::Status fault = absl::InvalidArgumentError("is not in the file");
    if (has(document_.images, index)) {
      const GltfSource& source = document_.images[static_cast<std::size_t>(index)];
      if (!source.file.empty()) return textures_.load(source.file, "", where);
      if (source.buffer_view >= 0) {
        const absl::StatusOr<std::span<const char>> bytes = accessors_.view(source.buffer_view);
        if (bytes.ok()) return textures_.decode(*bytes, name, where);
        fault = bytes.status();
      } else if (const absl::StatusOr<std::string> bytes = decode_data_uri(source.data_uri); bytes.ok()) {
        return textures_.decode(*bytes, name, where);
      }
    }
    add_warning(soup_.warnings,
                absl::StrFormat("%s: the texture '%s' cannot be read (%s), so it is left out.", where, name, fault.message()));
    return nullptr;
  }

  // Nodes can repeat a mesh, and accessors the same bytes, any number of times.
  absl::Status check_room(std::uint64_t count, std::string_view what) const {
    const std::uint64_t most = accessors_.most_elements();
    if (count <= most) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrFormat("the scene repeats its meshes until it has more than %d %s; split it", most, what));
  }

  const GltfDocument& document_;
  const GltfModel& model_;
  PolygonSoup soup_;
  GltfAccessors accessors_;
  TextureLoader textures_;
  const ExecutionContext& context_;
  std::optional<ReadMonitor> monitor_;  // counts instances
  std::size_t instances_done_ = 0, primitives_done_ = 0;
  bool is_quantised_ = false;                                  // the normals
  std::map<std::array<std::int64_t, 4>, std::size_t> blocks_;  // of the mesh at hand: first vertex by accessors, Draco data
};

}  // namespace

absl::StatusOr<PolygonSoup> read_gltf(const MeshFile& file, const ExecutionContext& context) {
  const absl::StatusOr<GltfDocument> document = parse_gltf(file.text());
  if (!document.ok()) return document.status();
  return GltfReader(file, context, *document).read();
}

}  // namespace curvecast
