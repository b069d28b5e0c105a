// SPDX-License-Identifier: Apache-2.0
// Decodes the point blocks of the API.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>

#include "client/lib/points.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

/// Decodes a block. DataLoss when it does not hold exactly `count` points with normals and radii, all finite, and colours or
/// none.
absl::StatusOr<Points> decode_block(const v1::PointBlock& block);

/// Decodes the blocks of a frame, several at once, and joins them. DataLoss as decode_block(), and for more than kMaxPoints
/// points in all or origins that differ.
absl::StatusOr<Points> decode_blocks(const google::protobuf::RepeatedPtrField<v1::PointBlock>& blocks);

/// Bytes that the points of a block take on the wire.
std::uint64_t encoded_bytes(const v1::PointBlock& block);
std::uint64_t encoded_bytes(const google::protobuf::RepeatedPtrField<v1::PointBlock>& blocks);

/// Whether both have values in the same columns, named ones under the same names in the same order.
bool have_same_columns(const Points& a, const Points& b);

/// Appends `more`, expressed in the origin of `points`; an empty `points` takes over the origin of `more`. Else they have the
/// same columns.
void append_points(Points more, Points* points);

}  // namespace curvecast::client
