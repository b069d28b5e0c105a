// SPDX-License-Identifier: Apache-2.0
#include "proto/terms/sample_names.h"

#include <algorithm>
#include <cstddef>

#include "proto/terms/choice.h"

namespace curvecast::terms {
namespace {

constexpr std::array<v1::Sampler, kSamplers.size()> kSamplerValues = {v1::SAMPLER_EQUALISED, v1::SAMPLER_PROGRESSIVE};
constexpr std::array<v1::Sequence, kSequences.size()> kSequenceValues = {v1::SEQUENCE_JITTERED, v1::SEQUENCE_REGULAR,
                                                                         v1::SEQUENCE_VAN_DER_CORPUT, v1::SEQUENCE_GOLDEN_RATIO,
                                                                         v1::SEQUENCE_VAN_DER_CORPUT};
constexpr std::array<v1::PointAttribute, kAttributes.size()> kAttributeValues = {
    v1::POINT_ATTRIBUTE_CURVATURES, v1::POINT_ATTRIBUTE_RANK, v1::POINT_ATTRIBUTE_SURFACE, v1::POINT_ATTRIBUTE_DIRECTIONS,
    v1::POINT_ATTRIBUTE_SCALARS};

template <class Value, std::size_t N>
absl::StatusOr<Value> value_of(std::string_view what, std::string_view name, const std::array<std::string_view, N>& names,
                               const std::array<Value, N>& values) {
  if (absl::Status status = check_choice(what, name, names); !status.ok()) return status;
  return values[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
}

}  // namespace

absl::StatusOr<v1::Sampler> parse_sampler(std::string_view name) { return value_of("sampler", name, kSamplers, kSamplerValues); }

absl::StatusOr<v1::Sequence> parse_sequence(std::string_view name) {
  return value_of("sequence", name, kSequences, kSequenceValues);
}

absl::StatusOr<v1::PointAttribute> parse_attribute(std::string_view name) {
  return value_of("attribute", name, kAttributes, kAttributeValues);
}

}  // namespace curvecast::terms
