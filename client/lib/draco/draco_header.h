// SPDX-License-Identifier: Apache-2.0
// Reads the start of a Draco point cloud.
//
// Draco's decoder trusts the counts in its input: a few dozen bytes can make it allocate gigabytes. So the header is read here
// first, and refused unless its counts agree with what is known and are possible for that many bytes.
#pragma once

#include <absl/status/statusor.h>
#include <absl/strings/string_view.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace curvecast::client {

/// Splat radii of a DracoPoints message: code c means min (max / min)^(c / 255). Not valid: no radii.
struct RadiusRange {
  float min = 0, max = 0;
  bool valid() const { return min > 0 && max >= min && max <= 3.4e38F; }
  bool operator==(const RadiusRange&) const = default;
};

/// Metadata entries in which our files keep that range: doubles.
inline constexpr char kRadiusMinEntry[] = "curvecast_radius_min";
inline constexpr char kRadiusMaxEntry[] = "curvecast_radius_max";

/// Draco's own numbers.
enum class DracoKind : std::uint8_t { kPosition = 0, kNormal = 1, kColour = 2, kGeneric = 4 };
inline constexpr std::uint8_t kDracoUint8 = 2, kDracoFloat = 9;

struct DracoAttribute {
  DracoKind kind = {};
  std::uint8_t type = 0;
  std::uint8_t components = 0;
};

struct DracoHeaderInfo {
  std::uint64_t points = 0;
  std::uint64_t bytes_per_point = 0;  // of all attributes together, decoded
  RadiusRange radii;                  // from the metadata of a file of ours
  bool sequential = false;            // or else by a kd-tree
  std::vector<DracoAttribute> attributes;
  std::size_t size = 0;  // bytes from DRACO to the end of the attributes' descriptions

  /// The first of its kind, the one that counts, or null.
  const DracoAttribute* find(DracoKind kind) const;
  /// Colours that can be shown: bytes, three or four to a point.
  bool has_colours() const;
};

/// The radius of every code, of a valid range.
std::array<float, 256> radius_table(RadiusRange range);

/// Reads the start of a Draco point cloud and bounds what decoding it can cost: at most `max_points` points, at most 256 points
/// per byte plus 65,536 (entropy coding spends next to nothing on points that hardly differ, so a small constant must be allowed
/// and then growth with the bytes), at most 64 bytes per point decoded. InvalidArgument for anything else.
absl::StatusOr<DracoHeaderInfo> check_draco_header(std::string_view bytes, std::uint64_t max_points);

/// InvalidArgument "broken Draco data: ...".
absl::Status broken_draco(absl::string_view what);

}  // namespace curvecast::client
