#include "core/mesh_io/ply_columns.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "core/mesh_io/reading/companion_name.h"
#include "core/mesh_io/reading/texture_loader.h"

namespace curvecast {
namespace {

// More are left out: each is carried along with the mesh from here to the clients.
constexpr std::size_t kMostScalars = 64;

class Planner {
 public:
  explicit Planner(const PlyElement& element) : element_(element), taken_(element.properties.size(), false) {
    std::size_t offset = 0;
    for (const PlyProperty& property : element.properties) {
      offsets_.push_back(offset);
      offset += ply_type_bytes(property.type);
    }
  }

  bool is_taken(std::size_t property) const { return taken_[property]; }

  std::size_t find(std::string_view name) const {
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      if (element_.properties[i].name == name && !element_.properties[i].is_list) return i;
    }
    return taken_.size();
  }
  bool has_all(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
      if (find(name) == taken_.size()) return false;
    }
    return true;
  }
  void take(std::size_t property, PlyColumn column) {
    taken_[property] = true;
    column.property = property;
    column.offset = offsets_[property];
    column.type = element_.properties[property].type;
    columns_.push_back(column);
  }
  /// Names that are not there are passed over.
  template <class T>
  void take_all(std::initializer_list<std::string_view> names, T* PlyColumn::*out, T* first) {
    PlyColumn column;
    column.step = names.size();
    for (const std::string_view name : names) {
      column.*out = first++;
      if (const std::size_t property = find(name); property < taken_.size()) take(property, column);
    }
  }
  /// `count` more behind the `first` colours that there are already.
  void take_colours(std::vector<Rgba8>& colours, std::size_t first, std::size_t count) {
    const auto take_named = [&](std::initializer_list<std::string_view> names) {
      if (!has_all({names.begin()[0], names.begin()[1], names.begin()[2]})) return false;
      colours.resize(std::min(colours.size(), first));
      colours.resize(first + count);
      take_all(names, &PlyColumn::colour, &colours.data()->r);
      return true;
    };
    static_assert(sizeof(Rgba8) == 4);
    take_named({"red", "green", "blue", "alpha"}) ||
        take_named({"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"}) || take_named({"r", "g", "b", "a"});
  }

  std::vector<PlyColumn> in_order() {
    std::sort(columns_.begin(), columns_.end(), [](const PlyColumn& a, const PlyColumn& b) { return a.property < b.property; });
    return std::move(columns_);
  }

 private:
  const PlyElement& element_;
  std::vector<bool> taken_;
  std::vector<std::size_t> offsets_;
  std::vector<PlyColumn> columns_;
};

}  // namespace

std::vector<PlyColumn> vertex_columns(const PlyElement& element, PolygonSoup& soup, std::vector<Vec2f>& uv) {
  Planner planner(element);
  MeshAttributes& attributes = soup.attributes;
  if (!planner.has_all({"x", "y", "z"})) return {};
  soup.positions.resize(element.count);
  planner.take_all({"x", "y", "z"}, &PlyColumn::real, soup.positions.data()->data());
  if (planner.has_all({"nx", "ny", "nz"})) {
    attributes.normals.resize(element.count);
    planner.take_all({"nx", "ny", "nz"}, &PlyColumn::single, attributes.normals.data()->data());
  }
  planner.take_colours(attributes.colours, 0, element.count);
  using Pair = std::initializer_list<std::string_view>;
  for (const Pair& names : {Pair{"s", "t"}, Pair{"u", "v"}, Pair{"texture_u", "texture_v"}, Pair{"texture_s", "texture_t"}}) {
    if (!uv.empty() || !planner.has_all(names)) continue;
    uv.resize(element.count);
    planner.take_all(names, &PlyColumn::single, uv.data()->data());
  }
  std::set<std::string> names;
  std::size_t left_out = 0;
  attributes.scalars.reserve(std::min(kMostScalars, element.properties.size()));
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (planner.is_taken(i) || element.properties[i].is_list) continue;
    if (attributes.scalars.size() == kMostScalars) {
      ++left_out;
      continue;
    }
    std::string name = display_name(element.properties[i].name);
    if (!names.insert(name).second) continue;
    attributes.scalars.push_back({.name = std::move(name), .values = std::vector<float>(element.count)});
    PlyColumn column;
    column.single = attributes.scalars.back().values.data();
    planner.take(i, column);
  }
  if (left_out > 0) {
    add_warning(soup.warnings, absl::StrFormat("Of the vertices' scalar properties %d are left out: more than %d are not kept.",
                                               left_out, kMostScalars));
  }
  return planner.in_order();
}

std::vector<PlyColumn> face_columns(const PlyElement& element, PolygonSoup& soup, std::vector<float>& texture_numbers) {
  Planner planner(element);
  const std::size_t first = soup.polygon_count();
  planner.take_colours(soup.attributes.face_colours, first, element.count);
  if (planner.has_all({"texnumber"})) {
    texture_numbers.resize(first, -1);
    texture_numbers.resize(first + element.count);
    planner.take_all({"texnumber"}, &PlyColumn::single, texture_numbers.data());
  }
  return planner.in_order();
}

}  // namespace curvecast
