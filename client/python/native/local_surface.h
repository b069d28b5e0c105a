// A surface in this process: what a server's session is, without a server. Knows nothing of Python.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/mutex.h"
#include "core/measure/signed_distance.h"
#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/reading/mesh_file.h"
#include "core/pipeline/pipeline.h"
#include "core/pipeline/scatter_mesh.h"
#include "core/remesh/feature_points.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/frame/reference_frame.h"
#include "server/frame/session_sampler.h"
#include "server/session/session.h"

namespace curvecast::python {

/// A mesh that was cut to charts, and the curves on it. Samples as a server would that had just opened the session: which points
/// come does not depend on what was asked before. Seeds of ranked points are those of requests. Thread-safe.
class LocalSurface {
 public:
  /// `options`: max_points = 0: the curve is made for as many points as are asked for, see curve_points(). `name`: of messages.
  /// `prepares`: cuts and flattens the mesh now, not when that is first needed. InvalidArgument: of the mesh (repair()) or the
  /// options; Cancelled.
  static absl::StatusOr<std::shared_ptr<LocalSurface>> make(PolygonSoup soup, const std::string& name,
                                                            const v1::SessionOptions& options, bool prepares,
                                                            const ExecutionContext& context);
  /// Reads a mesh file. Errors also as of read_mesh().
  static absl::StatusOr<std::shared_ptr<LocalSurface>> read(const MeshFile& file, const v1::SessionOptions& options,
                                                            bool prepares, const ExecutionContext& context);

  LocalSurface(LoadedMesh loaded, std::string name, const PreprocessOptions& options, bool is_sized)
      : name_(std::move(name)),
        options_(options),
        is_sized_(is_sized),
        loaded_(std::make_shared<const LoadedMesh>(std::move(loaded))) {}
  LocalSurface(FlattenedMesh flattened, std::string name, const PreprocessOptions& options, bool is_sized)
      : name_(std::move(name)),
        options_(options),
        is_sized_(is_sized),
        flattened_(std::make_shared<const FlattenedMesh>(std::move(flattened))),
        loaded_(flattened_, &flattened_->loaded) {}

  /// What the file held and what repair made of it.
  v1::MeshInfo info() const;
  /// The repaired mesh.
  const LoadedMesh& mesh() const { return *loaded_; }

  /// Samples as `request` says, and tells which attributes it selects; where the curve is too coarse for that it is made finer
  /// first. InvalidArgument: a budget that is for what is sent.
  absl::StatusOr<server::Sampled> sample(const v1::SampleRequest& request, server::PointAttributes& wanted,
                                         const ExecutionContext& context);
  /// Scatters points straight on the mesh: see scatter_mesh(). InvalidArgument as of to_scatter_request().
  absl::StatusOr<ScatteredPoints> scatter(const v1::SampleRequest& request, const ExecutionContext& context) const;
  /// The messages of the API's answer.
  absl::StatusOr<std::vector<v1::RemeshResponse>> remesh(const v1::RemeshRequest& request, const ExecutionContext& context);
  /// Measures sets of points in absolute coordinates against the mesh. Of the request neither mesh nor sets count.
  absl::StatusOr<v1::Measures> measure(const v1::MeasureRequest& request, std::span<const std::vector<Vec3d>> sets,
                                       const ExecutionContext& context);
  /// A frame with all that the view wants; a delta where `reference`, what the caller holds, allows one. `reference` becomes what
  /// is held after the frame, or null.
  absl::StatusOr<v1::PointFrame> frame(const v1::SampleRequest& request, std::shared_ptr<const server::ReferenceFrame>& reference,
                                       const ExecutionContext& context);
  /// Places points on sharp edges: see sample_features(). Their places are those of the repaired mesh.
  FeaturePoints features(double degrees, std::size_t points, std::uint64_t seed, const ExecutionContext& context) const;
  /// Finds signed distances: see SignedDistance.
  absl::StatusOr<std::vector<double>> distances(std::span<const Vec3d> points, const ExecutionContext& context);

 private:
  /// A surface of the mesh that `load` gives.
  static absl::StatusOr<std::shared_ptr<LocalSurface>> of(const std::string& name, const v1::SessionOptions& options,
                                                          bool prepares, const ExecutionContext& context,
                                                          const std::function<absl::StatusOr<LoadedMesh>()>& load);
  /// The session that a request is for: with a curve for as many points and, for ranked ones, with its seed. Made when it is
  /// first asked for. OutOfRange: more points than are made.
  absl::StatusOr<std::shared_ptr<const server::Session>> session(const server::PointSetRequest& request,
                                                                 const ExecutionContext& context);
  absl::Status refine(const server::Session& session, const SurfaceCurve& coarse, std::uint64_t points, const Density& density,
                      const ExecutionContext& context);

  const std::string name_;
  const PreprocessOptions options_;
  const bool is_sized_;                             // options_.points was asked for
  std::shared_ptr<const FlattenedMesh> flattened_;  // null: not needed yet; else changed under making_ alone
  const std::shared_ptr<const LoadedMesh> loaded_;
  server::ViewCache cache_;
  Mutex making_;                                        // of the flat mesh, of sessions, and of finer curves
  using Key = std::pair<std::uint64_t, std::uint64_t>;  // points of the curve, seed of the ranked points
  std::map<Key, std::shared_ptr<const server::Session>> sessions_ ABSL_GUARDED_BY(making_);
  Mutex measuring_;
  std::optional<SignedDistance> distance_ ABSL_GUARDED_BY(measuring_);  // made when it is first asked for
};

/// For how many points the curve is made that samples so many: 4,096, 16,384 or 65,536, else as many.
std::uint64_t curve_points(std::uint64_t points);

}  // namespace curvecast::python
