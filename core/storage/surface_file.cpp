#include "core/storage/surface_file.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "core/flatten/distortion.h"
#include "core/storage/archive.h"
#include "core/storage/pipeline_archive.h"
#include "core/storage/section_file.h"

namespace curvecast {

/// What a material is but for its picture.
struct MaterialRecord {
  std::string name;
  std::array<std::uint8_t, 4> colour = {};
  std::uint32_t texture = kNone;  // number of its picture
};

struct TextureRecord {
  std::int32_t width = 0, height = 0;
};

/// What is no array.
struct SurfaceRecord {
  MeshInfo info;
  PreprocessReport report;
  std::vector<std::string> scalars;
  std::vector<MaterialRecord> materials;
  std::vector<TextureRecord> textures;
  std::vector<std::uint8_t> parameterisations;  // one for each chart
  std::vector<std::uint64_t> chart_lengths;     // for each chart the length of each of its arrays
};

template <typename Archive, ConstOr<MaterialRecord> T>
void archive(Archive& fields, T& record) {
  fields(record.name, record.colour, record.texture);
}
template <typename Archive, ConstOr<TextureRecord> T>
void archive(Archive& fields, T& record) {
  fields(record.width, record.height);
}
template <typename Archive, ConstOr<SurfaceRecord> T>
void archive(Archive& fields, T& record) {
  auto& [info, report, scalars, materials, textures, parameterisations, chart_lengths] = record;
  fields(info, report, scalars, materials, textures, parameterisations, chart_lengths);
}

namespace {

constexpr FileKind kKind = {"SURFACE", kSurfaceFileVersion};
constexpr std::size_t kMaxSide = 1 << 20;  // pixels of a picture

/// How a value lies in a file; Eigen's vectors are plain numbers, but the compiler doesn't know.
template <typename T>
struct Stored {
  using Type = T;
};
template <typename Number, int n>
struct Stored<Eigen::Matrix<Number, n, 1>> {
  using Type = std::array<Number, n>;
};
template <typename T>
using StoredAs = typename Stored<T>::Type;

template <typename T>
std::span<const StoredAs<T>> stored(const std::vector<T>& values) {
  static_assert(sizeof(StoredAs<T>) == sizeof(T));
  return {reinterpret_cast<const StoredAs<T>*>(values.data()), values.size()};
}

template <typename T>
void restore(std::span<const StoredAs<T>> from, std::vector<T>& to) {
  to.resize(from.size());
  if (!from.empty()) std::memcpy(static_cast<void*>(to.data()), from.data(), from.size_bytes());
}

/// The one list of the arrays of a mesh and its attributes, scalars and pictures apart.
template <typename Mesh, typename Visit>
void visit_mesh(Mesh& loaded, Visit&& visit) {
  visit("positions", loaded.mesh.positions);
  visit("triangles", loaded.mesh.triangles);
  visit("twins", loaded.mesh.twins);
  visit("colours", loaded.attributes.colours);
  visit("normals", loaded.attributes.normals);
  visit("corner uv", loaded.attributes.uv);
  visit("face colours", loaded.attributes.face_colours);
  visit("face materials", loaded.attributes.material_of_face);
}

/// The one list of the arrays of a chart. In files, those of all charts follow each other.
constexpr std::size_t kChartArrays = 6;
template <typename AnyChart, typename Visit>
void visit_chart(AnyChart& chart, Visit&& visit) {
  visit("disc positions", chart.disc.positions);
  visit("disc triangles", chart.disc.triangles);
  visit("disc twins", chart.disc.twins);
  visit("disc faces", chart.disc.face_of);
  visit("disc borders", chart.disc.border);
  visit("disc uv", chart.uv);
}

std::string scalar_section(std::size_t i) { return absl::StrCat("scalar ", i); }
std::string texture_section(std::size_t i) { return absl::StrCat("texture ", i); }

/// The pictures in the order of their first use; materials share them.
std::vector<const Image*> number_textures(const std::vector<Material>& materials, SurfaceRecord& record) {
  std::map<const Image*, std::uint32_t> numbers;
  std::vector<const Image*> textures;
  for (const Material& material : materials) {
    const Rgba8 c = material.colour;
    MaterialRecord& out = record.materials.emplace_back(MaterialRecord{material.name, {c.r, c.g, c.b, c.a}, kNone});
    const Image* const texture = material.texture.get();
    if (texture == nullptr) continue;
    const auto [found, is_new] = numbers.try_emplace(texture, static_cast<std::uint32_t>(textures.size()));
    if (is_new) {
      textures.push_back(texture);
      record.textures.push_back({texture->width, texture->height});
    }
    out.texture = found->second;
  }
  return textures;
}

absl::Status load_attributes(const SectionFile& file, SurfaceRecord& record, MeshAttributes& attributes) {
  for (std::size_t i = 0; i < record.scalars.size(); ++i) {
    const auto values = file.section<float>(scalar_section(i));
    if (!values.ok()) return values.status();
    restore(*values, attributes.scalars.emplace_back(ScalarAttribute{std::move(record.scalars[i]), {}}).values);
  }
  std::vector<std::shared_ptr<const Image>> textures;
  for (const auto& [width, height] : record.textures) {
    auto image = std::make_shared<Image>(Image{width, height, {}});
    const auto pixels = file.section<std::uint8_t>(texture_section(textures.size()));
    if (!pixels.ok()) return pixels.status();
    restore(*pixels, image->rgba);
    textures.push_back(std::move(image));
  }
  for (MaterialRecord& material : record.materials) {
    const auto [r, g, b, a] = material.colour;
    if (material.texture != kNone && material.texture >= textures.size()) {
      return absl::DataLossError(absl::StrCat(file.path(), ": a material has a picture that is not there"));
    }
    attributes.materials.push_back(
        {std::move(material.name), {r, g, b, a}, material.texture != kNone ? textures[material.texture] : nullptr});
  }
  return absl::OkStatus();
}

absl::Status load_charts(const SectionFile& file, const SurfaceRecord& record, std::vector<Chart>& charts) {
  const std::size_t count = record.parameterisations.size();
  const auto senseless = [&file] { return absl::DataLossError(absl::StrCat(file.path(), ": its charts make no sense")); };
  if (record.chart_lengths.size() != count * kChartArrays) return senseless();
  charts.resize(count);
  for (std::size_t c = 0; c < count; ++c) {
    if (record.parameterisations[c] > static_cast<std::uint8_t>(Parameterisation::kUniform)) return senseless();
    charts[c].parameterisation = static_cast<Parameterisation>(record.parameterisations[c]);
  }
  absl::Status status;
  std::array<std::uint64_t, kChartArrays> begin = {};
  for (std::size_t c = 0; c < count; ++c) {
    std::size_t array = 0;
    visit_chart(charts[c], [&]<typename T>(const char* name, std::vector<T>& values) {
      const auto all = file.section<StoredAs<T>>(name);
      const std::uint64_t length = record.chart_lengths[c * kChartArrays + array];
      std::uint64_t& at = begin[array++];
      if (!all.ok()) {
        status = all.status();
      } else if (length > all->size() - at) {
        status = senseless();
      } else {
        restore(all->subspan(at, length), values);
        at += length;
      }
    });
    if (!status.ok()) return status;
  }
  return status;
}

absl::Status check_mesh(const TriangleMesh& mesh, const char* what) {
  const auto wrong = [what](const char* problem) { return absl::InvalidArgumentError(absl::StrCat(what, problem)); };
  const std::size_t vertices = mesh.vertex_count();
  const std::size_t faces = mesh.face_count();
  if (vertices == 0 || faces == 0 || vertices >= kNone || faces >= kNone / 3) return wrong(" has no face, or too many");
  for (const Vec3d& p : mesh.positions) {
    if (!p.allFinite()) return wrong(" has a vertex that is nowhere");
  }
  for (const Triangle& t : mesh.triangles) {
    if (t[0] >= vertices || t[1] >= vertices || t[2] >= vertices) return wrong(" has a face with a vertex that is not there");
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return wrong(" has a face with one vertex twice");
  }
  if (mesh.twins.size() != 3 * faces) return wrong(" has not three halfedges for each face");
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    const std::uint32_t twin = mesh.twins[h];
    if (twin == kNone) continue;
    if (twin >= mesh.twins.size() || mesh.twins[twin] != h || mesh.from(twin) != mesh.to(h) || mesh.to(twin) != mesh.from(h)) {
      return wrong(" has an edge whose two sides disagree");
    }
  }
  return absl::OkStatus();
}

absl::Status check_attributes(const MeshAttributes& attributes, const TriangleMesh& mesh) {
  const auto wrong = [](const char* problem) { return absl::InvalidArgumentError(absl::StrCat("the mesh has ", problem)); };
  const auto is_none_or = [](const auto& values, std::size_t size) { return values.empty() || values.size() == size; };
  const std::size_t vertices = mesh.vertex_count();
  const std::size_t faces = mesh.face_count();
  bool good = is_none_or(attributes.colours, vertices) && is_none_or(attributes.normals, vertices) &&
              is_none_or(attributes.uv, 3 * faces) && is_none_or(attributes.face_colours, faces) &&
              is_none_or(attributes.material_of_face, faces);
  for (const ScalarAttribute& scalar : attributes.scalars) good = good && scalar.values.size() == vertices;
  if (!good) return wrong("attributes of the wrong length");
  for (const std::uint32_t material : attributes.material_of_face) {
    if (material >= attributes.materials.size() && material != MeshAttributes::kNoMaterial) {
      return wrong("a face of a material that is not there");
    }
  }
  for (const Material& material : attributes.materials) {
    if (material.texture == nullptr) continue;
    const auto [width, height, rgba] = std::tie(material.texture->width, material.texture->height, material.texture->rgba);
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    if (width < 1 || height < 1 || w > kMaxSide || h > kMaxSide || rgba.size() != 4 * w * h) return wrong("a broken picture");
  }
  return absl::OkStatus();
}

absl::Status check_chart(const Chart& chart, std::size_t mesh_faces) {
  const auto wrong = [](const char* problem) { return absl::InvalidArgumentError(absl::StrCat("a disc has ", problem)); };
  const DiscMesh& disc = chart.disc;
  if (absl::Status status = check_mesh(disc, "a disc"); !status.ok()) return status;
  if (disc.face_of.size() != disc.face_count() || chart.uv.size() != disc.vertex_count()) {
    return wrong("arrays of the wrong length");
  }
  for (const std::uint32_t face : disc.face_of) {
    if (face >= mesh_faces) return wrong("a part of a face that is not there");
  }
  for (const Vec2d& uv : chart.uv) {
    if (!((uv.array() >= 0).all() && (uv.array() <= 1).all())) return wrong("a vertex outside of the square");
  }
  for (std::size_t t = 0; t < disc.face_count(); ++t) {
    const double ratio = area_ratio(disc, chart.uv, t);
    if (!(std::isfinite(ratio) && ratio > 0)) return wrong("a triangle that is flipped or empty");
  }
  std::vector<bool> seen(disc.vertex_count(), false);
  for (const std::uint32_t v : disc.border) {
    if (v >= seen.size() || seen[v]) return wrong("a border that is no loop");
    seen[v] = true;
  }
  return disc.border.size() >= 4 ? absl::OkStatus() : wrong("a border of fewer than four vertices");
}

}  // namespace

absl::Status check_surface(const FlattenedMesh& surface) {
  const TriangleMesh& mesh = surface.loaded.mesh;
  if (absl::Status status = check_mesh(mesh, "the mesh"); !status.ok()) return status;
  if (absl::Status status = check_attributes(surface.loaded.attributes, mesh); !status.ok()) return status;
  if (surface.charts.empty()) return absl::InvalidArgumentError("the surface has no disc");
  for (const Chart& chart : surface.charts) {
    if (absl::Status status = check_chart(chart, mesh.face_count()); !status.ok()) return status;
  }
  const MeshInfo& info = surface.report.mesh;
  if (!(std::isfinite(info.area) && info.area > 0 && info.box.min.allFinite() && info.box.max.allFinite())) {
    return absl::InvalidArgumentError("the surface's area or box is out of range");
  }
  return absl::OkStatus();
}

absl::Status save_surface(const std::string& path, const FlattenedMesh& surface) {
  SurfaceRecord record;
  record.info = surface.loaded.info;
  record.report = surface.report;
  const MeshAttributes& attributes = surface.loaded.attributes;
  const std::vector<const Image*> textures = number_textures(attributes.materials, record);
  std::vector<Section> sections;
  visit_mesh(surface.loaded,
             [&](const char* name, const auto& values) { sections.push_back(make_section(name, stored(values))); });
  for (const ScalarAttribute& scalar : attributes.scalars) {
    sections.push_back(make_section(scalar_section(record.scalars.size()), scalar.values));
    record.scalars.push_back(scalar.name);
  }
  for (std::size_t i = 0; i < textures.size(); ++i) {
    sections.push_back(make_section(texture_section(i), textures[i]->rgba));
  }
  std::vector<Section> of_charts;
  const Chart none;
  visit_chart(none, [&]<typename T>(const char* name, const std::vector<T>& /*values*/) {
    of_charts.push_back({name, sizeof(T), {}});
  });
  for (const Chart& chart : surface.charts) {
    record.parameterisations.push_back(static_cast<std::uint8_t>(chart.parameterisation));
    std::size_t array = 0;
    visit_chart(chart, [&](const char* /*name*/, const auto& values) {
      record.chart_lengths.push_back(values.size());
      of_charts[array++].parts.push_back(std::as_bytes(stored(values)));
    });
  }
  for (Section& section : of_charts) sections.push_back(std::move(section));
  const std::string record_bytes = to_archive(record);
  sections.push_back(make_section("record", record_bytes));
  return write_section_file(path, kKind, sections);
}

absl::StatusOr<FlattenedMesh> load_surface(const std::string& path) {
  const absl::StatusOr<std::shared_ptr<const SectionFile>> file = SectionFile::open(path, kKind);
  if (!file.ok()) return file.status();
  const auto record_bytes = (*file)->section<char>("record");
  if (!record_bytes.ok()) return record_bytes.status();
  SurfaceRecord record;
  if (!from_archive({record_bytes->data(), record_bytes->size()}, record)) {
    return absl::DataLossError(absl::StrCat(path, ": its record makes no sense"));
  }
  FlattenedMesh surface;
  surface.loaded.info = std::move(record.info);
  surface.report = std::move(record.report);
  absl::Status status;
  visit_mesh(surface.loaded, [&]<typename T>(const char* name, std::vector<T>& values) {
    const auto section = (*file)->section<StoredAs<T>>(name);
    if (section.ok()) {
      restore(*section, values);
    } else {
      status = section.status();
    }
  });
  if (!status.ok()) return status;
  if (status = load_attributes(**file, record, surface.loaded.attributes); !status.ok()) return status;
  if (status = load_charts(**file, record, surface.charts); !status.ok()) return status;
  const auto senseless = [&](const absl::Status& problem) {
    return absl::DataLossError(absl::StrCat(path, ": its surface makes no sense: ", problem.message()));
  };
  if (status = check_surface(surface); !status.ok()) return senseless(status);
  surface.geometry = differential_geometry(surface.loaded.mesh);
  return surface;
}

}  // namespace curvecast
