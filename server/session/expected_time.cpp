#include "server/session/expected_time.h"

#include <algorithm>

#include "core/pipeline/scatter_mesh.h"

namespace curvecast::server {
namespace {

// Seconds. Binary files have some twenty bytes a triangle, texts more, which take longer to read.
constexpr double kPerByte = 0.1e-6, kPerVertex = 0.3e-6;
constexpr double kCgalFactor = 6;                                  // times as long as with our own parameteriser
constexpr double kPerCandidate = 30e-6, kMostCandidates = 65'536;  // of those that a session has at first
constexpr double kPerRemeshed = 12e-6;
constexpr double kSurface = 1;
constexpr double kPerRead = 0.03e-6, kPerScattered = 0.3e-6, kPerMove = 0.5e-6;  // byte, point, point and round

std::chrono::nanoseconds to_time(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds));
}

}  // namespace

std::chrono::nanoseconds expected_time(std::uint64_t mesh_bytes, const PreprocessOptions& options) {
  const double mesh = kPerByte * static_cast<double>(mesh_bytes);
  const auto points = static_cast<double>(options.points);
  const double curve = kPerVertex * options.omega * points + kPerCandidate * std::min(points, kMostCandidates);
  const bool is_cgal = options.parameteriser == Parameteriser::kCgal;
  return to_time((is_cgal ? kCgalFactor : 1) * mesh + curve);
}

std::chrono::nanoseconds expected_scatter_time(std::uint64_t mesh_bytes, const MeshScatter& wanted) {
  const double of_point = kPerScattered + kPerMove * wanted.rounds;
  return to_time(kPerRead * static_cast<double>(mesh_bytes) + of_point * static_cast<double>(wanted.points));
}

std::chrono::nanoseconds expected_remesh_time(std::uint64_t points) {
  return to_time(kPerRemeshed * static_cast<double>(points));
}

std::chrono::nanoseconds expected_surface_time() { return to_time(kSurface); }

}  // namespace curvecast::server
