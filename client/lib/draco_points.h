// Decodes the point blocks of the API, and Draco point clouds in general.
//
// Draco's decoder trusts the counts in its input: a few dozen bytes can make it allocate gigabytes. So the header is read here
// first, and refused unless its counts agree with what is known and are possible for that many bytes.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string_view>

#include "client/lib/points.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

inline constexpr std::uint64_t kMaxPoints = 4'000'000;  // of one point set, as in the API

/// Splat radii of a DracoPoints message: code c means min (max / min)^(c / 255). Not valid: no radii.
struct RadiusRange {
  float min = 0, max = 0;
  bool valid() const { return min > 0 && max >= min && max <= 3.4e38F; }
};

/// Metadata entries in which our files keep that range: doubles.
inline constexpr char kRadiusMinEntry[] = "curvecast_radius_min";
inline constexpr char kRadiusMaxEntry[] = "curvecast_radius_max";

struct DracoHeaderInfo {
  std::uint64_t points = 0;
  std::uint64_t bytes_per_point = 0;  // of all attributes together, decoded
  RadiusRange radii;                  // from the metadata of a file of ours
};

/// Reads the start of a Draco point cloud and bounds what decoding it can cost: at most kMaxPoints points, at most 256 points per
/// byte plus 65,536 (entropy coding spends next to nothing on points that hardly differ, so a small constant must be allowed and
/// then growth with the bytes), at most 64 bytes per point decoded. InvalidArgument for anything else.
absl::StatusOr<DracoHeaderInfo> check_draco_header(std::string_view bytes);

/// Decodes a Draco point cloud with POSITION, optionally NORMAL, COLOR of three or four bytes, and a one-byte GENERIC attribute
/// as radius where the range is valid; alpha and colours of other types are skipped. The origin is zero. InvalidArgument when
/// check_draco_header() or Draco refuses it, or a value is not finite.
absl::StatusOr<Points> decode_draco(std::string_view bytes, RadiusRange radii);

/// Decodes a block. DataLoss when it does not hold exactly `count` points with normals and radii, all finite, and colours or
/// none.
absl::StatusOr<Points> decode_block(const v1::PointBlock& block);

/// Decodes the blocks of a frame, several at once, and joins them. DataLoss as decode_block(), and for more than kMaxPoints
/// points in all or origins that differ.
absl::StatusOr<Points> decode_blocks(const google::protobuf::RepeatedPtrField<v1::PointBlock>& blocks);

/// Bytes that the points of a block take on the wire.
std::uint64_t encoded_bytes(const v1::PointBlock& block);
std::uint64_t encoded_bytes(const google::protobuf::RepeatedPtrField<v1::PointBlock>& blocks);

/// Appends `more`, expressed in the origin of `points`; an empty `points` takes over the origin of `more`.
void append_points(Points more, Points* points);

}  // namespace curvecast::client
