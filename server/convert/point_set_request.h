// What a client wants of a point set, checked.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/codec/draco_codec.h"
#include "core/sample/resample.h"

namespace curvecast::server {

/// Which sampler places the points: resample() or sample_ranked().
enum class Sampler { kEqualised, kProgressive };

/// What is sent with each point besides position, normal, radius and colour.
struct PointAttributes {
  bool curvatures = false;  // both principal curvatures
  bool rank = false;        // only the progressive sampler has ranks
  bool surface = false;     // triangle and barycentric coordinates
  bool directions = false;  // of the least principal curvature
  bool scalars = false;     // the mesh's named values

  /// Whether the points' places on faces are needed.
  bool need_places() const { return surface || need_surface(); }
  /// Whether what the mesh has at these places is needed.
  bool need_surface() const { return directions || scalars; }

  bool operator==(const PointAttributes&) const = default;
};

/// Asks for as many points as keep up with the camera: see FramePace.
struct AutomaticBudget {
  double frame_seconds = 0.1;
  std::uint64_t max_points = 200'000;
};

/// DracoOptions.position_bits of a request: as many as its cameras' pixels ask for, see view_lattice.h.
inline constexpr int kAutomaticBits = 0;

/// A v1::SampleRequest that was validated as far as that goes without the session. At most one budget is set: `options.points`
/// counts where none of the other three is.
struct PointSetRequest {
  Sampler sampler = Sampler::kEqualised;
  PointAttributes attributes;
  ResampleOptions options;
  int relaxation_rounds = 0;    // of the equalised sampler: see move_apart()
  double pixel_error = 0;       // pixels; 0: not set
  std::uint64_t max_bytes = 0;  // 0: not set
  std::optional<AutomaticBudget> automatic;
  std::optional<DracoOptions> draco;           // its bits, or kAutomaticBits; the lattice is the session's. Not set: raw floats
  std::array<std::uint64_t, 2> fingerprint{};  // hash of the v1::SampleRequest
};

}  // namespace curvecast::server
