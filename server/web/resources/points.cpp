#include "server/web/resources/points.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "proto/terms/density_term.h"
#include "proto/terms/sample_names.h"
#include "server/base/log.h"
#include "server/base/status_from_exceptions.h"
#include "server/web/resources/answers.h"
#include "server/web/resources/json.h"
#include "server/web/resources/query.h"
#include "server/web/web_camera.h"

namespace curvecast::server {
namespace {

using Async = v1::CurvecastService::StubInterface::async_interface;
using Part = std::pair<std::string, std::string>;

constexpr char kParts[] =
    "n, pixel_error, density, camera, seed, sampler, sequence, relax, attributes, splats=true|false, "
    "glb=floats|quantised|meshopt, "
    "position_bits, normal_bits";
constexpr double kPictureHeight = 1024;     // pixels, for which pixel_error is meant
constexpr std::uint64_t kBytesOfPoint = 3;  // copies of a point's columns: as they come, gathered, and in the file

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

/// One request, from the session to the file.
class PointsRequest : public std::enable_shared_from_this<PointsRequest> {
 public:
  PointsRequest(std::shared_ptr<WebResource> resource, const PointFileKind& kind, PointsTerms terms)
      : resource_(std::move(resource)),
        kind_(kind),
        terms_(std::move(terms)),
        memory_(resource_->engine().memory, &resource_->gone(), {.waits = false}) {}

  void begin(v1::Session session) {
    session_ = std::move(session);
    tag_ = etag_of(session_, resource_->request());
    if (matches(resource_->request(), tag_)) return resource_->answer(not_modified(tag_));
    if (absl::Status status = complete_sample(terms_.cameras, session_, terms_.sample); !status.ok()) {
      return resource_->fail(status);
    }
    if (absl::Status status = resource_->engine().queued.check(resource_->caller().name); !status.ok()) {
      return resource_->fail(status);
    }
    request_.set_session_id(session_.session_id());
    *request_.mutable_sample() = terms_.sample;
    auto* const call = new ApiReadCall<v1::ResampleResponse>(
        resource_->calls(), [self = shared_from_this()](v1::ResampleResponse response) { return self->take(response); },
        [self = shared_from_this()](const absl::Status& refused, const grpc::Status& status) {
          if (!refused.ok()) return self->resource_->fail(refused);
          status.ok() ? self->make() : self->resource_->fail(status);
        });
    resource_->stub().async()->Resample(resource_->introduced(), &request_, call);
    call->start();
  }

 private:
  absl::Status take(const v1::ResampleResponse& response) {
    if (absl::Status status = memory_.take(kBytesOfPoint * response.ByteSizeLong(), "the points of a file"); !status.ok()) {
      return status;
    }
    if (response.has_statistics()) statistics_ = response.statistics();
    return points_.append(response.points());
  }

  /// A worker makes the file: neither gRPC's threads nor the gateway's should be busy for so long.
  void make() {
    const Caller& caller = resource_->caller();
    const absl::Status submitted =
        resource_->engine()
            .calls.submit([self = shared_from_this()] { self->finish(); }, {.caller = caller.name, .connection = caller.address})
            .status();
    if (!submitted.ok()) resource_->fail(submitted);
  }

  void finish() {
    if (resource_->gone()) return;
    PointFile file;
    const absl::Status made = status_from_exceptions([&] {
      absl::StatusOr<PointFile> written = make_point_file(points_.columns(), kind_, terms_.file);
      if (written.ok()) file = *std::move(written);
      return written.status();
    });
    if (!made.ok()) return resource_->fail(made);
    points_ = {};
    // What is being made, or could not be, may be there when the same is asked for again.
    const bool is_final = !statistics_.refining() &&
                          (statistics_.limit() == v1::POINT_LIMIT_UNSPECIFIED || statistics_.limit() == v1::POINT_LIMIT_DENSITY);
    WebAnswer answer = file_answer(std::move(file.bytes), std::string(kind_.type), is_final ? tag_ : "");
    answer.header.insert(answer.header.end(), file.header.begin(), file.header.end());
    answer.header.emplace_back("Content-Disposition", file_name_field(session_, std::string(kind_.ending)));
    if (statistics_.refining()) answer.header.emplace_back("Curvecast-Refining", "true");
    answer.held = hold_queued(resource_->engine(), resource_->caller(), answer.body.size());
    resource_->answer(std::move(answer));
  }

  const std::shared_ptr<WebResource> resource_;
  const PointFileKind& kind_;
  PointsTerms terms_;
  v1::Session session_;
  std::string tag_;
  v1::ResampleRequest request_;
  MemoryBudget::Job memory_;
  GatheredPoints points_;
  v1::FrameStatistics statistics_;
};

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
  const auto& attributes = sample.attributes();
  const bool is_asked = std::find(attributes.begin(), attributes.end(), v1::POINT_ATTRIBUTE_RANK) != attributes.end();
  if (sample.sampler() == v1::SAMPLER_PROGRESSIVE && kind.is_ranked && !is_asked) sample.add_attributes(v1::POINT_ATTRIBUTE_RANK);
  return terms;
}

absl::Status complete_sample(const std::vector<terms::CameraTerm>& cameras, const v1::Session& session,
                             v1::SampleRequest& sample) {
  if (sample.budget_case() == v1::SampleRequest::BUDGET_NOT_SET) sample.set_points(session.options().max_points());
  const bool wants_camera = std::any_of(sample.density().begin(), sample.density().end(), terms::is_camera_term) ||
                            sample.budget_case() == v1::SampleRequest::kPixelError;
  std::vector<terms::CameraTerm> all = cameras;
  if (all.empty() && wants_camera) all.emplace_back();
  if (all.empty()) return absl::OkStatus();
  const double aspect = all.front().aspect.value_or(1);
  for (const terms::CameraTerm& term : all) {
    if (term.aspect.value_or(1) != aspect) {
      return absl::InvalidArgumentError("camera: the pictures of all cameras have the same aspect");
    }
    absl::StatusOr<v1::Camera> camera = complete_camera(term, session.report().mesh(), aspect);
    if (!camera.ok()) return camera.status();
    *sample.add_cameras() = *std::move(camera);
  }
  sample.mutable_viewport()->set_width(static_cast<std::uint32_t>(std::lround(aspect * kPictureHeight)));
  sample.mutable_viewport()->set_height(static_cast<std::uint32_t>(kPictureHeight));
  return absl::OkStatus();
}

void get_points(const std::shared_ptr<WebResource>& resource, const std::string& session_id, const PointFileKind& kind) {
  absl::StatusOr<PointsTerms> terms = read_points_query(resource->query(), kind);
  if (!terms.ok()) return resource->fail(terms.status());
  v1::GetSessionRequest request;
  request.set_session_id(session_id);
  resource->call<v1::GetSessionRequest, v1::GetSessionResponse>(
      &Async::GetSession, std::move(request),
      [points = std::make_shared<PointsRequest>(resource, kind, *std::move(terms))](v1::GetSessionResponse found) {
        points->begin(std::move(*found.mutable_session()));
      });
}

}  // namespace curvecast::server
