#include "core/storage/surface_file.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/storage/section_file.h"
#include "core/storage/surface_layout.h"

namespace curvecast {

namespace {

constexpr FileKind kKind = {"SURFACE", kSurfaceFileVersion};
constexpr std::size_t kMaxSide = 1 << 20;  // pixels of a picture

/// The pictures in the order of their first use; materials share them.
std::vector<const Image*> number_textures(std::span<const Material> materials, SurfaceRecord& record) {
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

/// A surface in a mapped file.
class MappedSurface {
 public:
  explicit MappedSurface(std::function<void(const absl::Status&)> on_damage) : on_damage_(std::move(on_damage)) {}
  MappedSurface(const MappedSurface&) = delete;

  absl::Status open(const std::string& path, std::string_view note);
  const CurveBase& base() const { return *base_; }

 private:
  absl::Status senseless(const char* what) const {
    return absl::DataLossError(absl::StrCat(file_->path(), ": its surface makes no sense: ", what));
  }
  absl::Status read_record(SurfaceRecord& record) const;
  absl::Status view_arrays(const SurfaceRecord& record);
  absl::Status view_charts(const SurfaceRecord& record);
  absl::Status load_materials(const SurfaceRecord& record);
  absl::Status check_lengths() const;
  absl::Status check_creases() const;
  absl::Status check_borders() const;
  absl::Status check_disc(std::size_t disc) const;
  absl::Status check_chart(const ChartArrays& chart) const;
  absl::Status check_faces(const ChartArrays& chart) const;

  /// Whether the file is sound where they lie.
  template <typename T>
  absl::Status check(std::span<const T> values) const {
    return file_->check(stored(values));
  }
  /// The same of some of what a face or a vertex may have.
  template <typename T>
  bool is_sound(std::span<const T> values, std::size_t first, std::size_t count) const {
    return values.empty() || check(values.subspan(first, count)).ok();
  }

  const std::function<void(const absl::Status&)> on_damage_;
  std::shared_ptr<const SectionFile> file_;
  SurfaceArrays arrays_;
  std::vector<ChartArrays> charts_;
  std::vector<Material> materials_;
  std::optional<SurfaceColour> colour_;
  std::optional<CurveBase> base_;
};

absl::Status MappedSurface::open(const std::string& path, std::string_view note) {
  absl::StatusOr<std::shared_ptr<const SectionFile>> file = SectionFile::open(path, kKind, FileAccess::kMapLazily);
  if (!file.ok()) return file.status();
  file_ = *std::move(file);
  SurfaceRecord record;
  if (absl::Status status = read_record(record); !status.ok()) return status;
  if (record.note != note) return file_->damaged("its surface is of another session");
  if (absl::Status status = view_arrays(record); !status.ok()) return status;
  if (absl::Status status = load_materials(record); !status.ok()) return status;
  if (absl::Status status = view_charts(record); !status.ok()) return status;
  if (absl::Status status = check_lengths(); !status.ok()) return status;
  if (absl::Status status = check_creases(); !status.ok()) return status;
  if (absl::Status status = check_borders(); !status.ok()) return status;
  if (has_colour(arrays_.colour)) colour_.emplace(arrays_.mesh, arrays_.colour);
  SurfaceData data;
  data.mesh = arrays_.mesh;
  data.geometry = arrays_.geometry;
  data.scalars = arrays_.scalars;
  data.colour = colour_ ? &*colour_ : nullptr;
  data.creases = {arrays_.crease_normals, arrays_.crease_faces};
  data.borders = arrays_.borders;
  std::vector<BaseChart> charts;
  for (std::size_t d = 0; d < charts_.size(); ++d) {
    charts.push_back({charts_[d], Column<std::uint8_t>::view(charts_[d].kinds, file_), record.fills_square[d] != 0});
  }
  base_.emplace(
      std::move(data), std::move(charts), Column<std::uint32_t>::view(arrays_.triangle_of, file_),
      [this](std::size_t disc) {
        absl::Status status = check_disc(disc);
        if (!status.ok() && on_damage_) on_damage_(status);
        return status;
      },
      [this] { return file_->status(); }, file_->is_mapped());
  return file_->status();
}

absl::Status MappedSurface::read_record(SurfaceRecord& record) const {
  const auto bytes = file_->section<char>("record");
  if (!bytes.ok()) return bytes.status();
  if (absl::Status status = check(*bytes); !status.ok()) return status;
  const bool is_read = from_archive({bytes->data(), bytes->size()}, record);
  return is_read && record.scalars < kNone ? absl::OkStatus() : senseless("its record");
}

absl::Status MappedSurface::view_arrays(const SurfaceRecord& record) {
  absl::Status status;
  for (std::uint64_t i = 0; i < record.scalars && status.ok(); ++i) {
    status = file_->section<float>(absl::StrCat("scalar ", i)).status();  // before there is room for absurdly many
    arrays_.scalars.emplace_back();
  }
  if (!status.ok()) return status;
  visit_arrays(arrays_, [&]<typename T>(const std::string& name, std::span<const T>& values) {
    const auto section = file_->section<StoredAs<T>>(name);
    if (section.ok()) {
      values = restored<T>(*section);
    } else {
      status = section.status();
    }
  });
  return status;
}

absl::Status MappedSurface::load_materials(const SurfaceRecord& record) {
  std::vector<std::shared_ptr<const Image>> textures;
  for (const auto& [width, height] : record.textures) {
    const auto pixels = file_->section<std::uint8_t>(texture_section(textures.size()));
    if (!pixels.ok()) return pixels.status();
    if (absl::Status status = check(*pixels); !status.ok()) return status;
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    if (width < 1 || height < 1 || w > kMaxSide || h > kMaxSide || pixels->size() != 4 * w * h)
      return senseless("a broken picture");
    textures.push_back(std::make_shared<Image>(Image{width, height, {pixels->begin(), pixels->end()}}));
  }
  for (const MaterialRecord& material : record.materials) {
    const auto [r, g, b, a] = material.colour;
    if (material.texture != kNone && material.texture >= textures.size()) {
      return senseless("a material has a picture that is not there");
    }
    materials_.push_back({material.name, {r, g, b, a}, material.texture != kNone ? textures[material.texture] : nullptr});
  }
  arrays_.colour.materials = materials_;
  return absl::OkStatus();
}

absl::Status MappedSurface::view_charts(const SurfaceRecord& record) {
  const std::size_t count = record.fills_square.size();
  if (count == 0 || record.chart_lengths.size() != count * kChartArrays) return senseless("its charts");
  charts_.resize(count);
  absl::Status status;
  std::array<std::uint64_t, kChartArrays> begin = {};
  for (std::size_t c = 0; c < count && status.ok(); ++c) {
    std::size_t array = 0;
    visit_chart(charts_[c], [&]<typename T>(const char* name, std::span<const T>& values) {
      const auto all = file_->section<StoredAs<T>>(name);
      const std::uint64_t length = record.chart_lengths[c * kChartArrays + array];
      std::uint64_t& at = begin[array++];
      if (!all.ok()) {
        status = all.status();
      } else if (length > all->size() - at) {
        status = senseless("its charts");
      } else {
        values = restored<T>(all->subspan(at, length));
        at += length;
      }
    });
  }
  return status;
}

absl::Status MappedSurface::check_lengths() const {
  const auto is_none_or = [](const auto& values, std::size_t size) { return values.empty() || values.size() == size; };
  const std::size_t vertices = arrays_.mesh.positions.size(), faces = arrays_.mesh.triangles.size();
  if (vertices == 0 || faces == 0 || vertices >= kNone || faces >= kNone / 3) return senseless("no face, or too many");
  const ColourView& colour = arrays_.colour;
  bool good = arrays_.geometry.size() == vertices && arrays_.triangle_of.size() == faces &&
              is_none_or(colour.colours, vertices) && is_none_or(colour.uv, 3 * faces) &&
              is_none_or(colour.face_colours, faces) && is_none_or(colour.material_of_face, faces);
  for (const std::span<const float> scalar : arrays_.scalars) good = good && scalar.size() == vertices;
  for (const ChartArrays& chart : charts_) {
    const std::size_t v = chart.positions.size(), f = chart.triangles.size();
    good = good && v > 0 && f > 0 && v < kNone && f < kNone / 3 && chart.twins.size() == 3 * f && chart.face_of.size() == f &&
           chart.kinds.size() == f && chart.uv.size() == v;
  }
  return good ? absl::OkStatus() : senseless("arrays of the wrong length");
}

absl::Status MappedSurface::check_creases() const {
  if (absl::Status status = check(arrays_.crease_normals); !status.ok()) return status;
  if (absl::Status status = check(arrays_.crease_faces); !status.ok()) return status;
  const auto is_normal = [&](std::uint32_t n) { return n == kNone || n < arrays_.crease_normals.size(); };
  std::uint64_t next = 0;
  for (const CreaseFace& crease : arrays_.crease_faces) {
    const bool good = crease.face >= next && std::all_of(crease.normals.begin(), crease.normals.end(), is_normal);
    if (!good) return senseless("its creases");
    next = std::uint64_t{crease.face} + 1;
  }
  return absl::OkStatus();
}

absl::Status MappedSurface::check_borders() const {
  if (absl::Status status = check(arrays_.borders); !status.ok()) return status;
  std::uint64_t next = 0;
  for (const std::uint32_t h : arrays_.borders) {
    if (h < next || h >= 3 * arrays_.mesh.triangles.size()) return senseless("its borders");
    next = std::uint64_t{h} + 1;
  }
  return absl::OkStatus();
}

absl::Status MappedSurface::check_disc(std::size_t disc) const {
  ChartArrays chart = charts_[disc];
  absl::Status status;
  visit_chart(chart, [&](const char* /*name*/, const auto& values) { status.Update(check(values)); });
  if (!status.ok()) return status;
  if (status = check_chart(chart); !status.ok()) return status;
  return check_faces(chart);
}

absl::Status MappedSurface::check_chart(const ChartArrays& chart) const {
  const std::size_t vertices = chart.positions.size();
  for (const Vec3d& p : chart.positions) {
    if (!p.allFinite()) return senseless("a disc has a vertex that is nowhere");
  }
  for (const Triangle& t : chart.triangles) {
    if (t[0] >= vertices || t[1] >= vertices || t[2] >= vertices) return senseless("a disc has a vertex that is not there");
  }
  const auto from = [&](std::uint32_t h) { return chart.triangles[h / 3][h % 3]; };
  for (std::uint32_t h = 0; h < chart.twins.size(); ++h) {
    const std::uint32_t twin = chart.twins[h];
    if (twin == kNone) continue;
    if (twin >= chart.twins.size() || chart.twins[twin] != h || from(twin) != from(next_halfedge(h)) ||
        from(next_halfedge(twin)) != from(h)) {
      return senseless("a disc has an edge whose two sides disagree");
    }
  }
  for (const Vec2d& uv : chart.uv) {
    if (!((uv.array() >= 0).all() && (uv.array() <= 1).all())) return senseless("a disc has a vertex outside of the square");
  }
  for (std::size_t t = 0; t < chart.triangles.size(); ++t) {
    const double ratio = area_ratio(chart, t);
    if (!(std::isfinite(ratio) && ratio > 0)) return senseless("a disc has a triangle that is flipped or empty");
  }
  return absl::OkStatus();
}

/// What the mesh has for a chart's faces and their vertices.
absl::Status MappedSurface::check_faces(const ChartArrays& chart) const {
  const MeshView& mesh = arrays_.mesh;
  const ColourView& colour = arrays_.colour;
  bool good = true;
  for (std::size_t t = 0; t < chart.face_of.size() && good; ++t) {
    const std::uint32_t f = chart.face_of[t];
    if (f >= mesh.triangles.size()) return senseless("a disc has a part of a face that is not there");
    good = is_sound(mesh.triangles, f, 1) && is_sound(arrays_.triangle_of, f, 1) && is_sound(colour.face_colours, f, 1) &&
           is_sound(colour.material_of_face, f, 1) && is_sound(colour.uv, 3 * std::size_t{f}, 3);
    if (!good) break;
    if (arrays_.triangle_of[f] >= chart.face_of.size()) return senseless("a face is in another disc");
    for (const std::uint32_t v : mesh.triangles[f]) {
      if (v >= mesh.positions.size()) return senseless("a face has a vertex that is not there");
      good = good && is_sound(mesh.positions, v, 1) && is_sound(arrays_.geometry, v, 1) && is_sound(colour.colours, v, 1);
      for (const std::span<const float> scalar : arrays_.scalars) good = good && is_sound(scalar, v, 1);
      if (good && !mesh.positions[v].allFinite()) return senseless("the mesh has a vertex that is nowhere");
    }
  }
  return good ? absl::OkStatus() : file_->damaged("what it has for a disc's faces has a wrong checksum");
}

}  // namespace

absl::Status save_surface(const std::string& path, const CurveBase& surface, std::string_view note) {
  if (!surface.is_all_sound()) return surface.status();
  const SurfaceData& data = surface.data;
  SurfaceArrays arrays{data.mesh, data.geometry, surface.triangle_of, data.creases.normals, data.creases.faces, data.borders,
                       {},        data.scalars};
  if (data.colour != nullptr) arrays.colour = data.colour->source();
  SurfaceRecord record;
  record.note = note;
  record.scalars = arrays.scalars.size();
  const std::vector<const Image*> textures = number_textures(arrays.colour.materials, record);
  std::vector<Section> sections;
  visit_arrays(arrays, [&]<typename T>(const std::string& name, std::span<const T> values) {
    sections.push_back(make_section(name, stored(values)));
  });
  for (std::size_t i = 0; i < textures.size(); ++i) {
    sections.push_back(make_section(texture_section(i), textures[i]->rgba));
  }
  std::vector<Section> of_charts;
  ChartArrays none;
  visit_chart(none, [&]<typename T>(const char* name, std::span<const T> /*values*/) {
    of_charts.push_back({name, sizeof(T), {}});
  });
  for (const BaseChart& chart : surface.charts) {
    record.fills_square.push_back(chart.fills_square ? 1 : 0);
    ChartArrays of_chart{chart, chart.kinds};
    std::size_t array = 0;
    visit_chart(of_chart, [&]<typename T>(const char* /*name*/, std::span<const T> values) {
      record.chart_lengths.push_back(values.size());
      of_charts[array++].parts.push_back(std::as_bytes(stored(values)));
    });
  }
  for (Section& section : of_charts) sections.push_back(std::move(section));
  const std::string record_bytes = to_archive(record);
  sections.push_back(make_section("record", record_bytes));
  return write_section_file(path, kKind, sections);
}

absl::StatusOr<std::shared_ptr<const CurveBase>> open_surface(const std::string& path, std::string_view note,
                                                              std::function<void(const absl::Status&)> on_damage) {
  const auto surface = std::make_shared<MappedSurface>(std::move(on_damage));
  if (absl::Status status = surface->open(path, note); !status.ok()) return status;
  return std::shared_ptr<const CurveBase>(surface, &surface->base());
}

absl::Status check_surface_file(const std::string& path) { return SectionFile::open(path, kKind, FileAccess::kMap).status(); }

}  // namespace curvecast
