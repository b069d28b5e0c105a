#include "server/web/resources/points_terms.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <cmath>

#include "core/pipeline/pipeline.h"
#include "proto/terms/density_term.h"
#include "proto/terms/sample_names.h"
#include "server/web/resources/query.h"
#include "server/web/web_camera.h"

namespace curvecast::server {
namespace {

using Part = std::pair<std::string, std::string>;

constexpr char kParts[] =
    "n, pixel_error, density, camera, seed, sampler, sequence, relax, attributes, splats=true|false, "
    "glb=floats|quantised|meshopt, "
    "position_bits, normal_bits";
constexpr double kPictureHeight = 1024;  // pixels, for which pixel_error is meant

template <class Value, class Set>
absl::Status set(absl::StatusOr<Value> value, const Set& set_value) {
  if (value.ok()) set_value(*std::move(value));
  return value.status();
}

absl::Status read_attributes(const Part& part, v1::SampleRequest& sample) {
  for (const absl::string_view name : absl::StrSplit(part.second, ',')) {
    absl::Status status =
        set(terms::parse_attribute({name.data(), name.size()}), [&](auto value) { sample.add_attributes(value); });
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status read_file_part(const Part& part, const PointFileKind& kind, PointFileTerms& file) {
  const auto& [name, value] = part;
  const bool is_mesh_format = kind.ending == "ply" || kind.ending == "glb";
  if (name == "splats" && (value == "true" || value == "false")) {
    if (!is_mesh_format) return bad_query_part(part, "splats are written to .ply, .glb and, always, .spz");
    return file.splats = value == "true", absl::OkStatus();
  }
  if (name == "glb" && kind.ending == "glb" && (value == "floats" || value == "quantised" || value == "meshopt")) {
    file.quantises = value != "floats";
    return file.compresses = value == "meshopt", absl::OkStatus();
  }
  int bits = 0;
  if ((name == "position_bits" || name == "normal_bits") && kind.ending == "drc" && absl::SimpleAtoi(value, &bits)) {
    const bool is_position = name == "position_bits";
    if (bits < (is_position ? 1 : 2) || bits > 30)
      return bad_query_part(part, is_position ? "must be 1 to 30" : "must be 2 to 30");
    return (is_position ? file.position_bits : file.normal_bits) = bits, absl::OkStatus();
  }
  return bad_query_part(part, absl::StrCat("is nothing that such a file has; there are: ", kParts));
}

bool asks_for_ranks(const v1::SampleRequest& sample) {
  const auto& attributes = sample.attributes();
  return std::find(attributes.begin(), attributes.end(), v1::POINT_ATTRIBUTE_RANK) != attributes.end();
}

/// "ID:NAME", of a file that was sent and the name that the mesh gives it.
absl::Status read_companion(const Part& part, std::map<std::string, std::string>& companions) {
  const std::pair<std::string, std::string> named = absl::StrSplit(part.second, absl::MaxSplits(':', 1));
  if (named.first.empty() || named.second.empty()) return bad_query_part(part, "must be ID:NAME, of a file that was sent");
  companions[named.second] = named.first;
  return absl::OkStatus();
}

}  // namespace

std::optional<absl::Status> read_sample_part(const Part& part, PointsTerms& terms) {
  v1::SampleRequest& sample = terms.sample;
  const auto& [name, value] = part;
  if (name == "n") {
    std::uint64_t n = 0;
    if (!absl::SimpleAtoi(value, &n)) return bad_query_part(part, "must be a number of points");
    return sample.set_points(n), absl::OkStatus();
  }
  if (name == "pixel_error") {
    double pixels = 0;
    if (!absl::SimpleAtod(value, &pixels)) return bad_query_part(part, "must be a number of pixels");
    return sample.set_pixel_error(pixels), absl::OkStatus();
  }
  if (name == "seed") {
    std::uint64_t seed = 0;
    if (!absl::SimpleAtoi(value, &seed)) return bad_query_part(part, "must be a whole number");
    return sample.set_seed(seed), absl::OkStatus();
  }
  if (name == "density") {
    return set(terms::parse_density_term(value), [&](v1::DensityTerm term) { *sample.add_density() = std::move(term); });
  }
  if (name == "camera") {
    return set(terms::parse_camera_term(value), [&](terms::CameraTerm camera) { terms.cameras.push_back(camera); });
  }
  if (name == "sampler") return set(terms::parse_sampler(value), [&](auto sampler) { sample.set_sampler(sampler); });
  if (name == "sequence") return set(terms::parse_sequence(value), [&](auto sequence) { sample.set_sequence(sequence); });
  if (name == "relax") {
    std::uint32_t rounds = 0;
    if (!absl::SimpleAtoi(value, &rounds)) return bad_query_part(part, "must be a whole number of rounds");
    return sample.set_relaxation_rounds(rounds), absl::OkStatus();
  }
  if (name == "attributes") return read_attributes(part, sample);
  return std::nullopt;
}

absl::StatusOr<PointsTerms> read_points_query(const WebResource::Query& query, const PointFileKind& kind) {
  PointsTerms terms;
  int budgets = 0;
  for (const Part& part : query) {
    budgets += part.first == "n" || part.first == "pixel_error" ? 1 : 0;
    absl::Status status;
    if (const std::optional<absl::Status> read = read_sample_part(part, terms)) {
      status = *read;
    } else {
      status = read_file_part(part, kind, terms.file);
    }
    if (!status.ok()) return status;
  }
  if (budgets > 1)
    return absl::InvalidArgumentError("query: n and pixel_error are given more than once; one of them says how many points");
  v1::SampleRequest& sample = terms.sample;
  sample.mutable_encoding()->mutable_raw();
  if (sample.sampler() == v1::SAMPLER_PROGRESSIVE && kind.is_ranked && !asks_for_ranks(sample))
    sample.add_attributes(v1::POINT_ATTRIBUTE_RANK);
  return terms;
}

bool has_cameras(const PointsTerms& terms) {
  const v1::SampleRequest& sample = terms.sample;
  return !terms.cameras.empty() || sample.budget_case() == v1::SampleRequest::kPixelError ||
         std::any_of(sample.density().begin(), sample.density().end(), terms::is_camera_term);
}

absl::Status complete_sample(const v1::MeshInfo& mesh, PointsTerms& terms) {
  if (!has_cameras(terms)) return absl::OkStatus();
  v1::SampleRequest& sample = terms.sample;
  std::vector<terms::CameraTerm> all = terms.cameras;
  if (all.empty()) all.emplace_back();
  const double aspect = all.front().aspect.value_or(1);
  for (const terms::CameraTerm& term : all) {
    if (term.aspect.value_or(1) != aspect) {
      return absl::InvalidArgumentError("camera: the pictures of all cameras have the same aspect");
    }
    absl::StatusOr<v1::Camera> camera = complete_camera(term, mesh, aspect);
    if (!camera.ok()) return camera.status();
    *sample.add_cameras() = *std::move(camera);
  }
  sample.mutable_viewport()->set_width(static_cast<std::uint32_t>(std::lround(aspect * kPictureHeight)));
  sample.mutable_viewport()->set_height(static_cast<std::uint32_t>(kPictureHeight));
  return absl::OkStatus();
}

absl::StatusOr<ScatterTerms> read_scatter_query(const WebResource::Query& query, const PointFileKind& kind) {
  ScatterTerms terms;
  WebResource::Query rest;
  for (const Part& part : query) {
    absl::Status status;
    if (part.first == "companion") {
      status = read_companion(part, terms.companions);
    } else if (double degrees = 0; part.first == "crease") {
      if (!absl::SimpleAtod(part.second, &degrees)) status = bad_query_part(part, "must be a number of degrees");
      terms.crease_degrees = degrees;
    } else {
      rest.push_back(part);
    }
    if (!status.ok()) return status;
  }
  absl::StatusOr<PointsTerms> points = read_points_query(rest, kind);
  if (!points.ok()) return points.status();
  terms.points = *std::move(points);
  v1::SampleRequest& sample = terms.points.sample;
  if (sample.budget_case() == v1::SampleRequest::BUDGET_NOT_SET) sample.set_points(PreprocessOptions().points);
  if (kind.is_ranked && !asks_for_ranks(sample)) sample.add_attributes(v1::POINT_ATTRIBUTE_RANK);
  return terms;
}

}  // namespace curvecast::server
