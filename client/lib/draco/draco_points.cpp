// SPDX-License-Identifier: Apache-2.0
#include "client/lib/draco/draco_points.h"

#include <exception>

#include "client/lib/draco/draco_library.h"

namespace curvecast::client {

absl::Status decode_draco_into(DracoReader& reader, std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii,
                               const PointColumns& to) {
  try {
    const absl::StatusOr<bool> was_read = reader.read(bytes, header, radii, to);
    if (!was_read.ok()) return was_read.status();
    return *was_read ? absl::OkStatus() : decode_with_draco(bytes, header, radii, to);
  } catch (const std::exception& error) {
    return broken_draco(error.what());
  }
}

absl::StatusOr<DecodedPoints> decode_draco(std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii) {
  if (header.find(DracoKind::kPosition) == nullptr) return broken_draco("it has no positions");
  DecodedPoints points;
  points.positions.resize(header.points);
  if (header.find(DracoKind::kNormal) != nullptr) points.normals.resize(header.points);
  if (header.find(DracoKind::kGeneric) != nullptr && radii.valid()) points.radii.resize(header.points);
  if (header.has_colours()) points.colours.resize(header.points);
  DracoReader reader;
  absl::Status status = decode_draco_into(reader, bytes, header, radii, points.columns());
  if (!status.ok()) return status;
  return points;
}

}  // namespace curvecast::client
