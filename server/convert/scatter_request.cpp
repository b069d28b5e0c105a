#include "server/convert/scatter_request.h"

#include <algorithm>
#include <utility>

#include "server/convert/convert.h"

namespace curvecast::server {
namespace {

void check_sample(FieldValidator& check, const v1::SampleRequest& sample) {
  if (sample.budget_case() != v1::SampleRequest::kPoints) {
    check.fail("sample", "does not say how many points; they are scattered by their number, not within a budget");
  }
  if (sample.sampler() == v1::SAMPLER_PROGRESSIVE) {
    check.fail("sample.sampler", "is progressive; points that are scattered have no fixed ranks: take those of a session");
  }
  if (sample.sequence() != v1::SEQUENCE_UNSPECIFIED && sample.sequence() != v1::SEQUENCE_JITTERED) {
    check.fail("sample.sequence", "is for sessions; points are scattered at equal steps along the curve");
  }
}

}  // namespace

absl::StatusOr<ScatterRequest> to_scatter_request(const v1::SampleRequest& sample, std::optional<double> crease_degrees) {
  FieldValidator check;
  check_sample(check, sample);
  if (crease_degrees) check.in_range("crease_degrees", *crease_degrees, 0.0, 180.0);
  if (!check.ok()) return check.status();
  // Of the equalised sampler, as which these points are, there would be no ranks.
  v1::SampleRequest rest = sample;
  const auto is_rank = [](int attribute) { return attribute == v1::POINT_ATTRIBUTE_RANK; };
  auto& attributes = *rest.mutable_attributes();
  attributes.erase(std::remove_if(attributes.begin(), attributes.end(), is_rank), attributes.end());
  absl::StatusOr<PointSetRequest> point_set = to_point_set_request(rest);
  if (!point_set.ok()) return point_set.status();
  point_set->attributes.rank = rest.attributes_size() < sample.attributes_size();
  ScatterRequest out;
  const ResampleOptions& options = point_set->options;
  out.scatter = {.density = options.density,
                 .points = options.points,
                 .seed = options.seed,
                 .rounds = point_set->relaxation_rounds,
                 .crease_degrees = crease_degrees,
                 .curvatures = point_set->attributes.curvatures,
                 .directions = point_set->attributes.directions,
                 .scalars = point_set->attributes.scalars,
                 .ranks = point_set->attributes.rank};
  out.point_set = *std::move(point_set);
  return out;
}

}  // namespace curvecast::server
