// SPDX-License-Identifier: Apache-2.0
// Takes a delta frame in: what the server changed in the list of points that the client holds.
#pragma once

#include <absl/status/statusor.h>

#include "client/lib/points.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

/// The list after the edits; `added` are the points of the frame. InvalidArgument for edits that do not fit the list: indices
/// that do not ascend or lie outside, other columns or another origin than those held.
absl::StatusOr<Points> apply_edits(const Points& held, const v1::PointEdits& edits, const Points& added);

}  // namespace curvecast::client
