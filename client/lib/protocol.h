// SPDX-License-Identifier: Apache-2.0
// Numbers that servers and clients agree on: those of the table at the top of curvecast.proto that a client needs.
#pragma once

#include <cstddef>
#include <cstdint>

namespace curvecast::client {

inline constexpr std::uint64_t kMaxPoints = 4'000'000;                // points of one point set, or of a frame's list
inline constexpr std::uint64_t kMaxNeighbourPairs = 64'000'000;       // neighbours of all points of one call
inline constexpr std::size_t kMaxCompanions = 256;                    // files that one mesh refers to
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 20;   // bytes of one chunk of an upload
inline constexpr std::size_t kMaxFrameBytes = std::size_t{32} << 20;  // bytes of the points of a frame, or of a picture
inline constexpr int kRadiusRungs = 64, kRadiusRungsPerOctave = 2;    // of the ladder of radii: see PointEdits.radius_max
inline constexpr int kMaxCurveLevel = 30;                             // deepest level of a quad of the curve

}  // namespace curvecast::client
