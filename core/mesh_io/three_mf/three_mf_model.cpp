#include "core/mesh_io/three_mf/three_mf_model.h"

#include <absl/status/statusor.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/text_scanner.h"
#include "core/mesh_io/reading/companion_name.h"
#include "core/mesh_io/reading/mesh_reading.h"
#include "core/mesh_io/reading/texture_loader.h"

namespace curvecast {
namespace {

constexpr std::string_view kCore = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
constexpr std::string_view kMaterial = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";
constexpr std::string_view kProduction = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
constexpr std::string_view kTriangleSets = "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07";
// Each takes a few hundred bytes, and a dozen or two of the text.
constexpr std::size_t kMostResources = 100'000, kMostMaterials = 65'536;

absl::Status bad_value(const char* key, std::string_view value) {
  return absl::InvalidArgumentError(absl::StrFormat("%s is '%s', which is none", key, printable(value)));
}

/// False where the attribute is not there.
absl::StatusOr<bool> read_number(const XmlAttributes& attributes, const char* key, std::uint32_t& number) {
  const std::optional<std::string_view> written = attributes.find(key);
  if (!written) return false;
  TextScanner scanner(*written);
  std::int64_t value = 0;
  scanner.skip_space();
  if (!scanner.integer(value) || value < 0 || value > UINT32_MAX) return bad_value(key, *written);
  number = static_cast<std::uint32_t>(value);
  return true;
}

absl::Status require_number(const XmlAttributes& attributes, const char* key, std::uint32_t& number) {
  const absl::StatusOr<bool> there = read_number(attributes, key, number);
  if (!there.ok()) return there.status();
  return *there ? absl::OkStatus() : absl::InvalidArgumentError(absl::StrFormat("there is no %s", key));
}

/// #RRGGBB or #RRGGBBAA.
std::optional<Rgba8> parse_colour(std::string_view written) {
  if ((written.size() != 7 && written.size() != 9) || written[0] != '#') return std::nullopt;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(written.data() + 1, written.data() + written.size(), value, 16);
  if (error != std::errc() || end != written.data() + written.size()) return std::nullopt;
  if (written.size() == 7) value = value << 8 | 255;
  const auto byte = [&](int shift) { return static_cast<std::uint8_t>(value >> shift); };
  return Rgba8{byte(24), byte(16), byte(8), byte(0)};
}

/// Twelve numbers: the rows of a matrix by which rows of coordinates are multiplied.
absl::StatusOr<Eigen::Affine3d> parse_transform(std::string_view written) {
  TextScanner scanner(written);
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 3; ++column) {
      scanner.skip_space();
      if (!scanner.number(transform.matrix()(column, row))) return bad_value("transform", written);
    }
  }
  scanner.skip_space();
  return scanner.at_end() ? absl::StatusOr<Eigen::Affine3d>(transform) : bad_value("transform", written);
}

}  // namespace

void ThreeMfParser::prefix(std::string_view prefix, std::string_view space) {
  if (stack_.empty()) space_of_[std::string(prefix)] = space;
}

absl::Status ThreeMfParser::start(const XmlName& name, const XmlAttributes& attributes) {
  const Inside around = stack_.empty() ? Inside::kNothing : stack_.back();
  Inside& inside = stack_.emplace_back(Inside::kPassed);
  if (around == Inside::kPassed) return absl::OkStatus();
  if (around == Inside::kNothing) {
    inside = Inside::kModel;
    return start_model(name, attributes);
  }
  const auto is = [&](Inside where, std::string_view local, std::string_view space = kCore) {
    return around == where && name.local == local && name.space == space;
  };
  if (is(Inside::kVertices, "vertex")) return add_vertex(attributes);
  if (is(Inside::kTriangles, "triangle")) return add_triangle(attributes);
  if (is(Inside::kComponents, "component")) return add_instance(attributes, object_->components);
  if (is(Inside::kBuild, "item")) return add_instance(attributes, model_.build);
  if (is(Inside::kMaterials, "base")) {
    if (materials_.size() == kMostMaterials) {
      return absl::InvalidArgumentError(absl::StrFormat("there are more than %d base materials", kMostMaterials));
    }
    Material& material = materials_.emplace_back();
    material.name = display_name(attributes.find("name").value_or(""));
    ++group_->count;
    return add_colour(attributes, "displaycolor", material.colour);
  }
  if (is(Inside::kColours, "color", kMaterial)) return add_colour(attributes, "color", group_->colours.emplace_back());
  if (around == Inside::kResources) return start_resource(name, attributes, inside);
  if (is(Inside::kModel, "resources")) {
    inside = Inside::kResources;
  } else if (is(Inside::kModel, "build")) {
    inside = Inside::kBuild;
  } else if (is(Inside::kObject, "mesh")) {
    inside = Inside::kMesh;
  } else if (is(Inside::kObject, "components")) {
    inside = Inside::kComponents;
  } else if (is(Inside::kMesh, "vertices")) {
    inside = Inside::kVertices;
  } else if (is(Inside::kMesh, "triangles")) {
    inside = Inside::kTriangles;
  } else {
    pass_over(name);
  }
  return absl::OkStatus();
}

absl::Status ThreeMfParser::end() {
  stack_.pop_back();
  return absl::OkStatus();
}

absl::Status ThreeMfParser::start_model(const XmlName& name, const XmlAttributes& attributes) {
  if (name.local != "model" || name.space != kCore) {
    return absl::InvalidArgumentError(absl::StrFormat("this is no 3MF model: it begins with '%s'", printable(name.local)));
  }
  TextScanner scanner(attributes.find("requiredextensions").value_or(""));
  for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
    const std::string_view prefix = scanner.word();
    const auto found = space_of_.find(prefix);
    const std::string_view space = found != space_of_.end() ? std::string_view(found->second) : prefix;
    if (space != kCore && space != kMaterial && space != kProduction && space != kTriangleSets) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the file requires the extension %s, which is not supported; export it without", display_name(space)));
    }
  }
  return absl::OkStatus();
}

absl::Status ThreeMfParser::start_resource(const XmlName& name, const XmlAttributes& attributes, Inside& inside) {
  const bool is_object = name.space == kCore && name.local == "object";
  const bool is_materials = name.space == kCore && name.local == "basematerials";
  const bool is_colours = name.space == kMaterial && name.local == "colorgroup";
  if (!is_object && !is_materials && !is_colours) {
    pass_over(name);
    return absl::OkStatus();
  }
  if (model_.objects.size() + groups_.size() >= kMostResources) {
    return absl::InvalidArgumentError(absl::StrFormat("there are more than %d objects and groups", kMostResources));
  }
  inside = is_object ? Inside::kObject : is_materials ? Inside::kMaterials : Inside::kColours;
  if (is_object) return start_object(attributes);
  std::uint32_t id = 0;
  if (absl::Status status = require_number(attributes, "id", id); !status.ok()) return status;
  group_ = &groups_[id];
  *group_ = {.first = materials_.size()};
  return absl::OkStatus();
}

absl::Status ThreeMfParser::start_object(const XmlAttributes& attributes) {
  std::uint32_t id = 0, property = 0;
  absl::Status status = require_number(attributes, "id", id);
  if (!status.ok()) return status;
  const auto [object, is_new] = model_.objects.try_emplace(id);
  if (!is_new) return absl::InvalidArgumentError(absl::StrFormat("there are two objects %d", id));
  object_ = &object->second;
  object_group_ = 0;
  object_look_ = {};
  const absl::StatusOr<bool> has_group = read_number(attributes, "pid", object_group_);
  if (!has_group.ok()) return has_group.status();
  const absl::StatusOr<bool> has_property = read_number(attributes, "pindex", property);
  if (!has_property.ok()) return has_property.status();
  return *has_group && *has_property ? look_of(object_group_, {property, property, property}, object_look_) : status;
}

absl::Status ThreeMfParser::add_vertex(const XmlAttributes& attributes) {
  Vec3d p;
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<std::string_view> written = attributes.find(kAxes[axis]);
    if (!written) return absl::InvalidArgumentError(absl::StrFormat("a vertex has no %s", kAxes[axis]));
    TextScanner scanner(*written);
    scanner.skip_space();
    if (!scanner.number(p[axis])) return bad_value(kAxes[axis], *written);
  }
  if (!is_finite(p)) return absl::InvalidArgumentError(kNotFinite);
  if (object_->positions.size() == kMaxVertices) return absl::InvalidArgumentError(kTooManyVertices);
  object_->positions.push_back(p);
  return absl::OkStatus();
}

absl::Status ThreeMfParser::add_triangle(const XmlAttributes& attributes) {
  std::array<std::uint32_t, 3> triangle;
  constexpr const char* kCorners[] = {"v1", "v2", "v3"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (absl::Status status = require_number(attributes, kCorners[i], triangle[i]); !status.ok()) return status;
    if (triangle[i] >= object_->positions.size()) {
      return absl::InvalidArgumentError(index_out_of_range(triangle[i], object_->positions.size()));
    }
  }
  ThreeMfLook look = object_look_;
  if (absl::Status status = read_look(attributes, look); !status.ok()) return status;
  if (look.material != MeshAttributes::kNoMaterial || look.colour != Rgba8{}) {
    grow(object_->looks, object_->triangles.size() + 1);
    object_->looks.resize(object_->triangles.size());
    object_->looks.push_back(look);
  }
  object_->triangles.push_back(triangle);
  return absl::OkStatus();
}

absl::Status ThreeMfParser::read_look(const XmlAttributes& attributes, ThreeMfLook& look) {
  std::array<std::uint32_t, 3> properties{};
  std::uint32_t group = object_group_;
  const absl::StatusOr<bool> has_group = read_number(attributes, "pid", group);
  if (!has_group.ok()) return has_group.status();
  const absl::StatusOr<bool> has_property = read_number(attributes, "p1", properties[0]);
  if (!has_property.ok()) return has_property.status();
  if (!*has_property || group == 0) return absl::OkStatus();
  properties[1] = properties[2] = properties[0];
  for (const auto& [key, i] : {std::pair{"p2", 1}, std::pair{"p3", 2}}) {
    if (const absl::StatusOr<bool> there = read_number(attributes, key, properties[static_cast<std::size_t>(i)]); !there.ok()) {
      return there.status();
    }
  }
  look = {};
  return look_of(group, properties, look);
}

absl::Status ThreeMfParser::look_of(std::uint32_t group, const std::array<std::uint32_t, 3>& properties, ThreeMfLook& look) {
  const auto found = groups_.find(group);
  if (found == groups_.end()) return absl::OkStatus();  // of textures, say, which have been warned of
  const auto& [first, count, colours] = found->second;
  const std::size_t size = colours.empty() ? count : colours.size();
  for (const std::uint32_t property : properties) {
    if (property >= size) {
      return absl::InvalidArgumentError(absl::StrFormat("group %d has no property %d (it has %d)", group, property, size));
    }
  }
  if (colours.empty()) {
    look.material = static_cast<std::uint32_t>(first + properties[0]);
    return absl::OkStatus();
  }
  const auto mean = [&](std::uint8_t Rgba8::*part) {
    int sum = 1;  // rounds
    for (const std::uint32_t property : properties) sum += found->second.colours[property].*part;
    return static_cast<std::uint8_t>(sum / 3);
  };
  look.colour = {mean(&Rgba8::r), mean(&Rgba8::g), mean(&Rgba8::b), mean(&Rgba8::a)};
  return absl::OkStatus();
}

absl::Status ThreeMfParser::add_instance(const XmlAttributes& attributes, std::vector<ThreeMfInstance>& to) {
  ThreeMfInstance instance;
  if (absl::Status status = require_number(attributes, "objectid", instance.object); !status.ok()) return status;
  if (const std::optional<std::string_view> written = attributes.find("transform")) {
    absl::StatusOr<Eigen::Affine3d> transform = parse_transform(*written);
    if (!transform.ok()) return transform.status();
    instance.transform = std::make_unique<const Eigen::Affine3d>(*transform);
  }
  if (std::optional<std::string_view> part = attributes.find("path", kProduction)) {
    if (part->starts_with('/')) part->remove_prefix(1);
    constexpr std::size_t kMostParts = 4'096;
    const auto [known, is_new] = part_of_.try_emplace(std::string(*part), static_cast<std::uint32_t>(model_.parts.size()));
    instance.part = known->second;
    if (is_new) model_.parts.emplace_back(*part);
    if (model_.parts.size() > kMostParts) {
      return absl::InvalidArgumentError(absl::StrFormat("it refers to more than %d other parts", kMostParts));
    }
  }
  to.push_back(std::move(instance));
  return absl::OkStatus();
}

absl::Status ThreeMfParser::add_colour(const XmlAttributes& attributes, const char* key, Rgba8& colour) {
  const std::optional<std::string_view> written = attributes.find(key);
  if (!written) return absl::InvalidArgumentError(absl::StrFormat("there is no %s", key));
  const std::optional<Rgba8> parsed = parse_colour(*written);
  if (!parsed) return bad_value(key, *written);
  colour = *parsed;
  return absl::OkStatus();
}

void ThreeMfParser::pass_over(const XmlName& name) {
  constexpr std::string_view kSilently[] = {"metadata", "metadatagroup", "trianglesets"};
  constexpr std::size_t kMost = 16;
  if (std::find(std::begin(kSilently), std::end(kSilently), name.local) != std::end(kSilently)) return;
  if (passed_.size() >= kMost || std::find(passed_.begin(), passed_.end(), name.local) != passed_.end()) return;
  passed_.emplace_back(name.local);
  add_warning(warnings_, absl::StrFormat("The elements '%s' of the 3MF are left out.", display_name(name.local)));
}

}  // namespace curvecast
