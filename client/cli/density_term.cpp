#include "client/cli/density_term.h"

#include <absl/strings/str_cat.h>

#include <fstream>
#include <iterator>
#include <string>

namespace curvecast::cli {
namespace {

absl::StatusOr<std::string> read_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) return absl::InvalidArgumentError(absl::StrCat("the file '", path, "' cannot be read"));
  return std::string(std::istreambuf_iterator<char>(file), {});
}

}  // namespace

absl::StatusOr<v1::DensityTerm> parse_density_term(std::string_view text) { return terms::parse_density_term(text, read_file); }

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
