#include "server/frame/surface_file.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/memory_claim.h"

namespace curvecast::server {
namespace {

// Draco's copy of the mesh, its corner table and what it notes while it walks over that: 94 to 109 bytes were measured for a
// triangle without colours.
constexpr std::uint64_t kBytesPerTriangle = 160;
constexpr std::size_t kTrianglesPerCheck = 1 << 16;  // between two looks at whether the client has gone

/// Whether each vertex has one colour, whichever of its faces is looked at.
bool has_vertex_colours_only(const ColourView& source) {
  const bool has_texture =
      std::any_of(source.materials.begin(), source.materials.end(), [](const Material& m) { return m.texture != nullptr; });
  const auto& material = source.material_of_face;
  const bool has_one_material = std::adjacent_find(material.begin(), material.end(), std::not_equal_to<>()) == material.end();
  return !has_texture && has_one_material && source.face_colours.empty();
}

/// Adds an attribute of three numbers for each of `count` vertices. Returns its number.
template <typename T, typename ValueOf>
int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data, std::size_t count,
                  const ValueOf& value_of) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, 3, data, false, 3 * sizeof(T), 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(count));
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::array<T, 3> value = value_of(v);
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), value.data());
  }
  return id;
}

/// Of each vertex, by the first of its faces.
std::vector<Rgba8> vertex_colours(const SurfaceData& data) {
  std::vector<Rgba8> colours(data.mesh.positions.size());
  std::vector<bool> is_known(colours.size());
  for (std::uint32_t f = 0; f < data.mesh.triangles.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t v = data.mesh.triangles[f][i];
      if (is_known[v]) continue;
      is_known[v] = true;
      colours[v] = data.colour->at(f, Vec3f::Unit(i), 0);
    }
  }
  return colours;
}

}  // namespace

absl::StatusOr<SurfaceFile> make_surface_file(const CurveBase& base, const Vec3d& origin, int position_bits,
                                              const ExecutionContext& context) {
  const MeshView& from = base.data.mesh;
  if (from.triangles.size() > kMaxSurfaceFaces) {
    return absl::OutOfRangeError(
        absl::StrFormat("the surface has %d triangles; those of up to %d are sent, of greater ones points", from.triangles.size(),
                        kMaxSurfaceFaces));
  }
  if (base.data.colour != nullptr && !has_vertex_colours_only(base.data.colour->source())) {
    return absl::FailedPreconditionError(
        "the surface has textures, or colours of faces, which points have and its triangles alone would not");
  }
  MemoryClaim claim(context);
  const std::uint64_t bytes = kBytesPerTriangle * from.triangles.size();
  if (absl::Status status = claim.set(bytes, absl::StrFormat("compressing %d triangles takes %s", from.triangles.size(),
                                                             describe_bytes(static_cast<double>(bytes))));
      !status.ok()) {
    return status;
  }
  if (!base.is_all_sound()) return base.status();

  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(from.positions.size()));
  const int position = add_attribute<float>(mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, from.positions.size(),
                                            [&](std::size_t v) {
                                              const Vec3f p = (from.positions[v] - origin).cast<float>();
                                              return std::array{p.x(), p.y(), p.z()};
                                            });
  if (base.data.colour != nullptr) {
    const std::vector<Rgba8> colours = vertex_colours(base.data);
    add_attribute<std::uint8_t>(mesh, draco::GeometryAttribute::COLOR, draco::DT_UINT8, colours.size(), [&](std::size_t v) {
      return std::array{colours[v].r, colours[v].g, colours[v].b};
    });
  }
  mesh.SetNumFaces(from.triangles.size());
  for (std::uint32_t f = 0; f < from.triangles.size(); ++f) {
    if (absl::Status status = f % kTrianglesPerCheck == 0 ? context.check() : absl::OkStatus(); !status.ok()) return status;
    const Triangle& t = from.triangles[f];
    mesh.SetFace(draco::FaceIndex(f), {draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
  }
  draco::ExpertEncoder encoder(mesh);
  encoder.SetAttributeQuantization(position, position_bits);
  encoder.SetTrackEncodedProperties(true);
  draco::EncoderBuffer buffer;
  if (const draco::Status status = encoder.EncodeToBuffer(&buffer); !status.ok()) {
    return absl::InternalError(absl::StrCat("Draco: ", status.error_msg_string()));
  }
  if (absl::Status status = context.check(); !status.ok()) return status;
  return SurfaceFile{.vertices = encoder.num_encoded_points(),
                     .triangles = encoder.num_encoded_faces(),
                     .origin = origin,
                     .bytes = std::string(buffer.data(), buffer.size())};
}

absl::StatusOr<std::shared_ptr<const SurfaceFile>> SurfaceFiles::get(const std::string& session_id, int position_bits,
                                                                     const Make& make) {
  const auto find = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return entry.session_id == session_id && entry.position_bits == position_bits;
    });
  };
  {
    const MutexLock lock(mutex_);
    if (const auto found = find(); found != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, found);
      return found->file;
    }
  }
  absl::StatusOr<SurfaceFile> made = make();
  if (!made.ok()) return made.status();
  auto file = std::make_shared<const SurfaceFile>(*std::move(made));
  const MutexLock lock(mutex_);
  if (find() != entries_.end() || file->bytes.size() > kMostBytes) return file;
  bytes_ += file->bytes.size();
  entries_.push_front({session_id, position_bits, file});
  for (; bytes_ > kMostBytes; entries_.pop_back()) bytes_ -= entries_.back().file->bytes.size();
  return file;
}

}  // namespace curvecast::server
