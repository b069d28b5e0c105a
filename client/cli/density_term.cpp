#include "client/cli/density_term.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/choice.h"

namespace curvecast::cli {
namespace {

constexpr std::array<std::string_view, 3> kTerms = {"uniform", "curvature", "view"};
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

}  // namespace

absl::StatusOr<v1::DensityTerm> parse_density_term(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string name(text.substr(0, colon));
  if (absl::Status status = check_choice("density term", name, kTerms); !status.ok()) return status;
  Settings settings;
  if (colon != std::string_view::npos) {
    absl::StatusOr<Settings> parsed = parse_settings(name, std::string(text.substr(colon + 1)));
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
    term.mutable_uniform();
    if (!settings.empty()) status = unknown_key(name, settings[0].first, "it takes no settings");
  }
  if (!status.ok()) return status;
  return term;
}

absl::Status add_density_terms(const std::vector<std::string>& texts,
                               google::protobuf::RepeatedPtrField<v1::DensityTerm>* terms) {
  for (const std::string& text : texts) {
    absl::StatusOr<v1::DensityTerm> term = parse_density_term(text);
    if (!term.ok()) return term.status();
    *terms->Add() = *std::move(term);
  }
  return absl::OkStatus();
}

}  // namespace curvecast::cli
