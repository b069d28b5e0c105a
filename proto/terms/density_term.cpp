// SPDX-License-Identifier: Apache-2.0
#include "proto/terms/density_term.h"

#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_split.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "proto/terms/choice.h"

namespace curvecast::terms {
namespace {

constexpr std::array<std::string_view, 10> kTerms = {"uniform", "curvature", "attribute", "brush",   "expression",
                                                     "view",    "screen",    "frustum",   "picture", "distance"};
constexpr std::array<std::string_view, 3> kKinds = {"gauss", "mean", "max"};

using Settings = std::vector<std::pair<std::string, std::string>>;

absl::StatusOr<Settings> parse_settings(const std::string& term, const std::string& text) {
  Settings settings;
  std::set<std::string> seen;
  for (const std::string& part : std::vector<std::string>(absl::StrSplit(text, ','))) {
    std::pair<std::string, std::string> setting = absl::StrSplit(part, absl::MaxSplits('=', 1));
    if (setting.first.empty() || setting.second.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(term, ": '", part, "' is not of the form key=value"));
    }
    if (!seen.insert(setting.first).second) {
      return absl::InvalidArgumentError(absl::StrCat(term, ": ", setting.first, " is given twice"));
    }
    settings.push_back(std::move(setting));
  }
  return settings;
}

absl::StatusOr<double> parse_number(const std::string& term, const std::pair<std::string, std::string>& setting, double min,
                                    double max, const std::string& range) {
  double value = 0;
  if (!absl::SimpleAtod(setting.second, &value) || !std::isfinite(value) || value < min || value > max) {
    return absl::InvalidArgumentError(absl::StrCat(term, ": ", setting.first, "=", setting.second, ": must be a number ", range));
  }
  return value;
}

absl::Status unknown_key(const std::string& term, const std::string& key, const std::string& known) {
  return absl::InvalidArgumentError(absl::StrCat(term, ": there is no '", key, "'; ", known));
}

absl::Status set_curvature(const Settings& settings, v1::CurvatureDensity* curvature) {
  const std::string term = "curvature";
  for (const auto& setting : settings) {
    if (setting.first == "kind") {
      if (absl::Status status = check_choice("curvature kind", setting.second, kKinds); !status.ok()) return status;
      curvature->set_kind(setting.second == "gauss"  ? v1::CURVATURE_KIND_GAUSS
                          : setting.second == "mean" ? v1::CURVATURE_KIND_MEAN
                                                     : v1::CURVATURE_KIND_MAX);
    } else if (setting.first == "exponent") {
      const auto value = parse_number(term, setting, 0, std::numeric_limits<double>::max(), "that is not negative");
      if (!value.ok()) return value.status();
      curvature->set_exponent(*value);
    } else if (setting.first == "floor") {
      const auto value = parse_number(term, setting, 0, 1, "from 0 to 1");
      if (!value.ok()) return value.status();
      curvature->set_floor(*value);
    } else {
      return unknown_key(term, setting.first, "there are: kind, exponent, floor");
    }
  }
  return absl::OkStatus();
}

absl::Status set_view(const Settings& settings, v1::ViewDensity* view) {
  for (const auto& setting : settings) {
    if (setting.first != "s0") return unknown_key("view", setting.first, "there is: s0");
    const auto value =
        parse_number("view", setting, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(), "above 0");
    if (!value.ok()) return value.status();
    view->set_s0(*value);
  }
  return absl::OkStatus();
}

absl::StatusOr<double> parse_number(const std::string& term, const std::string& key, const std::string& text,
                                    bool may_be_negative) {
  const double min = may_be_negative ? std::numeric_limits<double>::lowest() : 0;
  return parse_number(term, {key, text}, min, std::numeric_limits<double>::max(),
                      may_be_negative ? "that is finite" : "that is not negative");
}

/// Appends a dab.
absl::Status add_dab(const std::string& text, v1::BrushDensity* term) {
  constexpr std::array<const char*, 6> kKeys = {"x", "y", "z", "radius", "factor", "falloff"};
  const std::vector<std::string> parts = absl::StrSplit(text, ',');
  if (parts.size() != 5 && parts.size() != 6) {
    return absl::InvalidArgumentError(
        absl::StrCat("brush: '", text, "' has ", parts.size(), " numbers; it takes x,y,z,radius,factor[,falloff]"));
  }
  std::array<double, 6> values{};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const absl::StatusOr<double> value = parse_number("brush", kKeys[i], parts[i], i < 3);
    if (!value.ok()) return value.status();
    values[i] = *value;
  }
  if (!(values[3] > 0)) return absl::InvalidArgumentError("brush: radius=0: must be a number above 0");
  if (values[4] > 1e6)
    return absl::InvalidArgumentError(absl::StrCat("brush: factor=", values[4], ": must be from 0 to 1,000,000"));
  if (values[5] > 1) return absl::InvalidArgumentError(absl::StrCat("brush: falloff=", values[5], ": must be from 0 to 1"));
  v1::BrushStroke* const brush = term->add_strokes();
  brush->mutable_centre()->set_x(values[0]);
  brush->mutable_centre()->set_y(values[1]);
  brush->mutable_centre()->set_z(values[2]);
  brush->set_radius(values[3]);
  brush->set_factor(values[4]);
  if (parts.size() == 6) brush->set_falloff(values[5]);
  return absl::OkStatus();
}

/// Dabs, one in each line.
absl::Status add_lines(const std::string& path, const std::string& text, v1::BrushDensity* brush) {
  int number = 0;
  for (std::string line : std::vector<std::string>(absl::StrSplit(text, '\n'))) {
    ++number;
    line = line.substr(0, line.find('#'));
    const std::vector<std::string> values = absl::StrSplit(line, absl::ByAnyChar(", \t\r"), absl::SkipEmpty());
    if (values.empty()) continue;
    if (absl::Status status = add_dab(absl::StrJoin(values, ","), brush); !status.ok()) {
      return absl::InvalidArgumentError(absl::StrCat(path, ", line ", number, ": ", status.message()));
    }
  }
  return absl::OkStatus();
}

/// Dabs separated by semicolons, or @ and a file with one in each line.
absl::Status set_brush(const std::string& text, const FileReader& read, v1::BrushDensity* brush) {
  if (absl::StartsWith(text, "@")) {
    if (read == nullptr) return absl::InvalidArgumentError("brush: files are read on a command line only; write the dabs out");
    const std::string path = text.substr(1);
    const absl::StatusOr<std::string> lines = read(path);
    if (!lines.ok()) return absl::InvalidArgumentError(absl::StrCat("brush: ", lines.status().message()));
    return add_lines(path, *lines, brush);
  }
  for (const std::string& dab : std::vector<std::string>(absl::StrSplit(text, ';'))) {
    if (absl::Status status = add_dab(dab, brush); !status.ok()) return status;
  }
  return absl::OkStatus();
}

/// Which law the number of points follows.
absl::StatusOr<v1::DistanceFall> parse_fall(const std::string& name) {
  if (name.empty() || name == "inverse-square") return v1::DISTANCE_FALL_INVERSE_SQUARE;
  if (name == "inverse") return v1::DISTANCE_FALL_INVERSE;
  if (name == "linear") return v1::DISTANCE_FALL_LINEAR;
  return absl::InvalidArgumentError(absl::StrCat("distance: global is '", name, "'; there are: inverse-square, inverse, linear"));
}

/// "near,far", "near=1,far=2,global=linear" or a mixture: numbers without a key come in this order.
absl::Status set_distance(const std::string& text, v1::DistanceDensity* distance) {
  std::set<std::string> seen;
  for (const std::string& part : std::vector<std::string>(absl::StrSplit(text, ','))) {
    std::string key = part, value;
    if (const std::size_t equals = part.find('='); equals != std::string::npos) {
      key = part.substr(0, equals);
      value = part.substr(equals + 1);
    } else if (part != "global") {
      key = seen.contains("near") ? "far" : "near";
      value = part;
    }
    if (!seen.insert(key).second) return absl::InvalidArgumentError(absl::StrCat("distance: ", key, " is given twice"));
    if (key == "global") {
      const absl::StatusOr<v1::DistanceFall> fall = parse_fall(value);
      if (!fall.ok()) return fall.status();
      distance->set_global(true);
      distance->set_fall(*fall);
      continue;
    }
    if (key != "near" && key != "far") return unknown_key("distance", key, "there are: near, far, global");
    const absl::StatusOr<double> number = parse_number("distance", key, value, false);
    if (!number.ok()) return number.status();
    key == "near" ? distance->set_near(*number) : distance->set_far(*number);
  }
  if (distance->far() != 0 && distance->far() < distance->near()) {
    return absl::InvalidArgumentError(absl::StrCat("distance: far=", distance->far(), " is less than near=", distance->near()));
  }
  if (distance->fall() == v1::DISTANCE_FALL_LINEAR && distance->far() == 0) {
    return absl::InvalidArgumentError("distance: global=linear needs a far, where no points are left");
  }
  return absl::OkStatus();
}

/// Those whose text is not made of settings. What is none of them stays empty.
absl::StatusOr<v1::DensityTerm> parse_free_term(const std::string& name, const std::optional<std::string>& text,
                                                const FileReader& read) {
  v1::DensityTerm term;
  if (name != "attribute" && name != "expression" && name != "brush" && name != "distance") return term;
  if (name == "distance" && !text) {
    term.mutable_distance();
    return term;
  }
  if (!text || text->empty()) {
    return absl::InvalidArgumentError(absl::StrCat(name, ": say more after a colon, as in ",
                                                   name == "attribute"    ? "attribute:quality"
                                                   : name == "expression" ? "'expression:1 + abs(mean)'"
                                                   : name == "brush"      ? "brush:0,0,1,0.2,4"
                                                                          : "distance:1,10"));
  }
  absl::Status status;
  if (name == "attribute") {
    term.mutable_attribute()->set_name(*text);
  } else if (name == "expression") {
    term.mutable_expression()->set_text(*text);
  } else {
    status = name == "brush" ? set_brush(*text, read, term.mutable_brush()) : set_distance(*text, term.mutable_distance());
  }
  if (!status.ok()) return status;
  return term;
}

}  // namespace

absl::StatusOr<v1::DensityTerm> parse_density_term(std::string_view text, const FileReader& read) {
  const std::size_t colon = text.find(':');
  const std::string name(text.substr(0, colon));
  if (absl::Status status = check_choice("density term", name, kTerms); !status.ok()) return status;
  const std::optional<std::string> after =
      colon == std::string_view::npos ? std::nullopt : std::optional<std::string>(text.substr(colon + 1));
  absl::StatusOr<v1::DensityTerm> free = parse_free_term(name, after, read);
  if (!free.ok() || free->term_case() != v1::DensityTerm::TERM_NOT_SET) return free;
  Settings settings;
  if (after) {
    absl::StatusOr<Settings> parsed = parse_settings(name, *after);
    if (!parsed.ok()) return parsed.status();
    settings = *std::move(parsed);
  }
  v1::DensityTerm term;
  absl::Status status;
  if (name == "curvature") {
    status = set_curvature(settings, term.mutable_curvature());
  } else if (name == "view") {
    status = set_view(settings, term.mutable_view());
  } else {
    if (name == "screen") term.mutable_screen();
    if (name == "frustum") term.mutable_frustum();
    if (name == "picture") term.mutable_picture();
    if (name == "uniform") term.mutable_uniform();
    if (!settings.empty()) status = unknown_key(name, settings[0].first, "it takes no settings");
  }
  if (!status.ok()) return status;
  return term;
}

bool is_camera_term(const v1::DensityTerm& term) {
  return term.has_view() || term.has_distance() || term.has_frustum() || term.has_screen() || term.has_picture();
}

}  // namespace curvecast::terms
