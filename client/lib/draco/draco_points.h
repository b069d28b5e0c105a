// SPDX-License-Identifier: Apache-2.0
// Decodes Draco point clouds.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "client/lib/draco/draco_header.h"
#include "client/lib/draco/draco_reader.h"
#include "client/lib/draco/point_columns.h"

namespace curvecast::client {

/// Decodes a Draco point cloud, whose header check_draco_header() has accepted, with POSITION, optionally NORMAL, COLOR of three
/// or four bytes, and a one-byte GENERIC attribute as radius where the range is valid; alpha and colours of other types are
/// skipped. InvalidArgument when DracoReader or, for what that does not know, Draco refuses it, or a value is not finite.
absl::StatusOr<DecodedPoints> decode_draco(std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii);

/// The same into columns of header.points elements: those that DracoReader::read() fills. Draco's own decoder takes what `reader`
/// does not know.
absl::Status decode_draco_into(DracoReader& reader, std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii,
                               const PointColumns& to);

}  // namespace curvecast::client
