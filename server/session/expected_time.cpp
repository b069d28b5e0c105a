#include "server/session/expected_time.h"

namespace curvecast::server {
namespace {

// Seconds. Binary files have some twenty bytes a triangle, texts more, which take longer to read.
constexpr double kPerByte = 0.1e-6, kPerVertex = 0.15e-6;
constexpr double kCgalFactor = 6;  // times as long as with our own parameteriser

}  // namespace

std::chrono::nanoseconds expected_time(std::uint64_t mesh_bytes, const PreprocessOptions& options) {
  const double mesh = kPerByte * static_cast<double>(mesh_bytes);
  const double curve = kPerVertex * options.omega * static_cast<double>(options.points);
  const bool is_cgal = options.parameteriser == Parameteriser::kCgal;
  const std::chrono::duration<double> seconds((is_cgal ? kCgalFactor : 1) * mesh + curve);
  return std::chrono::duration_cast<std::chrono::nanoseconds>(seconds);
}

}  // namespace curvecast::server
