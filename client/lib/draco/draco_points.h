// Decodes Draco point clouds.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "client/lib/draco/draco_header.h"
#include "client/lib/draco/draco_reader.h"
#include "client/lib/draco/point_columns.h"
#include "client/lib/points.h"

namespace curvecast::client {

/// Decodes a Draco point cloud with POSITION, optionally NORMAL, COLOR of three or four bytes, and a one-byte GENERIC attribute
/// as radius where the range is valid; alpha and colours of other types are skipped. The origin is zero. InvalidArgument when
/// check_draco_header(), DracoReader or, for what that does not know, Draco refuses it, or a value is not finite.
absl::StatusOr<Points> decode_draco(std::string_view bytes, RadiusRange radii);

/// Decodes a Draco point cloud, whose header is known, into columns of header.points elements: those that DracoReader::read()
/// fills. Draco's own decoder takes what `reader` does not know. InvalidArgument as decode_draco().
absl::Status decode_draco_into(DracoReader& reader, std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii,
                               const PointColumns& to);

}  // namespace curvecast::client
