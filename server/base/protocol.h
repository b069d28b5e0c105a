// Numbers that servers and clients agree on: those of the table at the top of curvecast.proto that core does not know.
#pragma once

#include <cstddef>
#include <cstdint>

namespace curvecast::server {

inline constexpr std::uint64_t kMaxMeasuredPoints = 8'000'000;               // points of all sets of one call
inline constexpr int kMaxMeasuredSets = 64;                                  // of one call
inline constexpr std::uint32_t kMaxNeighbours = 64;                          // of one point, of a call that counts them
inline constexpr std::uint64_t kMaxNeighbourPairs = 64'000'000;              // neighbours of all points of one call
inline constexpr int kMaxDensityTerms = 16;                                  // of one request
inline constexpr std::size_t kMaxDabs = 10'000;                              // of the brush, of one request
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 20;          // bytes of one chunk of an upload
inline constexpr std::size_t kMaxFrameBytes = std::size_t{32} << 20;         // bytes of the points of a frame, or of a picture
inline constexpr std::size_t kMaxFramesInFlight = 2;                         // frames of a stream that are not acknowledged
inline constexpr std::uint64_t kMinBudgetBytes = 1024;                       // enough for a point, however it is encoded
inline constexpr std::size_t kMaxSocketCalls = 64;                           // at once, of one WebSocket
inline constexpr std::size_t kMaxSocketMessageBytes = std::size_t{2} << 20;  // received

}  // namespace curvecast::server
