#include "server/session/session.h"

#include <absl/strings/str_format.h>
#include <sys/resource.h>

#include "core/storage/pipeline_archive.h"
#include "server/base/hash.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kHalf = 16;  // digits

}  // namespace

std::string session_id(const MeshFiles& files, const PreprocessOptions& options) {
  Hasher hasher;
  const std::string all_options = to_archive(options);
  hasher.update(absl::StrFormat("%d\n%s\n%d\n", kAlgorithmVersion, files.mesh->key, all_options.size()));
  hasher.update(all_options);
  for (const auto& [name, file] : files.companions) {
    hasher.update(absl::StrFormat("%d %s\n%s\n", name.size(), name, file->id));
  }
  return files.mesh->id.substr(0, kHalf) + hasher.hex().substr(0, kHalf);
}

absl::StatusOr<std::shared_ptr<const CurveBase>> Session::curve_base() const { return surface->base(); }

absl::StatusOr<std::shared_ptr<const LeafSurface>> Session::leaf_surface(const std::shared_ptr<const SurfaceCurve>& curve,
                                                                         const ExecutionContext& context) const {
  return surface->leaves(curve, context);
}

absl::StatusOr<RankedCurve> Session::ranks(const ExecutionContext& context) const {
  return candidates->take([this, &context] { return leaf_surface(revisions->first(), context); }, options.points, options.seed,
                          context);
}

absl::Status Session::status() const {
  for (const auto& file : files) {
    if (absl::Status status = file->status(); !status.ok()) return status;
  }
  return surface->status();
}

std::uint64_t Session::memory_bytes() const {
  const std::shared_ptr<const SurfaceCurve> first = revisions->first(), newest = curve();
  return newest->byte_size() + (first != newest ? first->byte_size() : 0) + candidates->byte_size() + surface->byte_size();
}

std::uint64_t peak_memory_bytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace curvecast::server
