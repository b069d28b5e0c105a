#include "client/python/native/local_surface.h"

#include <algorithm>
#include <utility>

#include "core/base/memory_claim.h"
#include "core/measure/measure_points.h"
#include "core/sample/resample.h"
#include "server/convert/convert.h"
#include "server/convert/convert_measure.h"
#include "server/convert/mesh_chunks.h"
#include "server/convert/scatter_request.h"
#include "server/frame/make_frame.h"
#include "server/frame/session_mesh.h"
#include "server/session/refiner.h"

namespace curvecast::python {
namespace {

constexpr int kMostRefinements = 4;  // a density may find the finer curve too coarse again
constexpr std::uint64_t kMostCurveVertices = 20'000'000;

struct Options {
  PreprocessOptions preprocess;
  bool is_sized;
};

absl::StatusOr<Options> to_options(v1::SessionOptions options) {
  const bool is_sized = options.max_points() != 0;
  absl::StatusOr<PreprocessOptions> preprocess = server::to_preprocess_options(options);
  if (!preprocess.ok()) return preprocess.status();
  return Options{*std::move(preprocess), is_sized};
}

/// What an answer lacks.
struct Lacking {
  std::uint64_t points = 0;  // above 0: the curve is too coarse for so many
  std::shared_ptr<const SurfaceCurve> curve;
  server::RankDemand ranks;
};

/// Makes all ranked candidates that a view lacks.
absl::Status grow(const server::Session& session, const server::RankDemand& demand, const ExecutionContext& context) {
  absl::StatusOr<server::RankedCurve> ranked = session.ranks(context);
  while (ranked.ok()) {
    const server::LackingRanks lacking = demand(ranked->tree);
    if (lacking.chunks.empty()) return absl::OkStatus();
    ranked = session.candidates->grow(lacking.chunks, context);
  }
  return ranked.status();
}

}  // namespace

std::uint64_t curve_points(std::uint64_t points) {
  for (const std::uint64_t step : {4'096u, 16'384u, 65'536u}) {
    if (points <= step) return step;
  }
  return std::min(points, kMaxPoints);
}

absl::StatusOr<std::shared_ptr<LocalSurface>> LocalSurface::make(PolygonSoup soup, const std::string& name,
                                                                 const v1::SessionOptions& options, bool prepares,
                                                                 const ExecutionContext& context) {
  return of(name, options, prepares, context, [&] { return load_mesh(std::move(soup), name, context); });
}

absl::StatusOr<std::shared_ptr<LocalSurface>> LocalSurface::read(const MeshFile& file, const v1::SessionOptions& options,
                                                                 bool prepares, const ExecutionContext& context) {
  return of(std::string(file.name), options, prepares, context, [&] { return load_mesh(file, context); });
}

absl::StatusOr<std::shared_ptr<LocalSurface>> LocalSurface::of(const std::string& name, const v1::SessionOptions& options,
                                                               bool prepares, const ExecutionContext& context,
                                                               const std::function<absl::StatusOr<LoadedMesh>()>& load) {
  const absl::StatusOr<Options> wanted = to_options(options);
  if (!wanted.ok()) return wanted.status();
  absl::StatusOr<LoadedMesh> loaded = load();
  if (!loaded.ok()) return loaded.status();
  if (!prepares) return std::make_shared<LocalSurface>(*std::move(loaded), name, wanted->preprocess, wanted->is_sized);
  absl::StatusOr<FlattenedMesh> flattened = flatten_mesh(*std::move(loaded), wanted->preprocess, context);
  if (!flattened.ok()) return flattened.status();
  return std::make_shared<LocalSurface>(*std::move(flattened), name, wanted->preprocess, wanted->is_sized);
}

v1::MeshInfo LocalSurface::info() const { return server::to_proto(loaded_->info, name_); }

absl::StatusOr<std::shared_ptr<const server::Session>> LocalSurface::session(const server::PointSetRequest& request,
                                                                             const ExecutionContext& context) {
  // Refused before a curve is made for so many.
  if (request.options.points > kMaxPoints) return check_sample(request.options.points, request.options.density);
  PreprocessOptions options = options_;
  if (!is_sized_) options.points = curve_points(request.options.points);
  options.seed = request.sampler == server::Sampler::kProgressive ? request.options.seed : 0;
  const MutexLock lock(making_);
  if (const auto found = sessions_.find({options.points, options.seed}); found != sessions_.end() && found->second != nullptr) {
    return found->second;
  }
  std::shared_ptr<const server::Session>& first = sessions_[{options.points, 0}];
  if (first == nullptr) {
    if (flattened_ == nullptr) {
      absl::StatusOr<FlattenedMesh> flattened = flatten_mesh(LoadedMesh(*loaded_), options_, context);
      if (!flattened.ok()) return flattened.status();
      flattened_ = std::make_shared<const FlattenedMesh>(*std::move(flattened));
    }
    absl::StatusOr<Preprocessed> preprocessed = lay_curve(flattened_, options, context);
    if (!preprocessed.ok()) return preprocessed.status();
    auto session = std::make_shared<server::Session>();
    session->mesh_name = name_;
    session->options = options;
    session->options.seed = 0;
    session->surface = std::make_shared<server::SessionSurface>(flattened_);
    session->preprocessed.report = preprocessed->report;
    session->revisions->publish(std::move(preprocessed->curve));
    first = std::move(session);
  }
  if (options.seed == 0) return first;
  auto session = std::make_shared<server::Session>(*first);  // shares curve and surface
  session->options.seed = options.seed;
  session->candidates = std::make_shared<server::RankedCandidates>();
  return sessions_[{options.points, options.seed}] = std::move(session);
}

absl::Status LocalSurface::refine(const server::Session& session, const SurfaceCurve& coarse, std::uint64_t points,
                                  const Density& density, const ExecutionContext& context) {
  const MutexLock lock(making_);
  if (session.curve()->revision > coarse.revision || session.refinement->is_over) return absl::OkStatus();
  const CurveDemand demand{points, density};
  const absl::StatusOr<RefinedCurve> refined = server::refine_session(session, {&demand, 1}, kMostCurveVertices, context);
  if (!refined.ok()) return refined.status();
  if (refined->curve == nullptr || refined->divisor > 1) session.refinement->is_over = true;
  return absl::OkStatus();
}

absl::StatusOr<server::Sampled> LocalSurface::sample(const v1::SampleRequest& request, server::PointAttributes& wanted,
                                                     const ExecutionContext& context) {
  const absl::StatusOr<server::PointSetRequest> point_set = server::to_point_set_request(request);
  if (!point_set.ok()) return point_set.status();
  wanted = point_set->attributes;
  if (point_set->automatic || point_set->max_bytes > 0) {
    return absl::InvalidArgumentError("a budget in bytes or seconds is for what is sent; ask for points or an error in pixels");
  }
  const absl::StatusOr<std::shared_ptr<const server::Session>> found = session(*point_set, context);
  if (!found.ok()) return found.status();
  for (int round = 0;; ++round) {
    absl::StatusOr<server::Sampled> sampled = server::sample_points(**found, *point_set, cache_, context);
    if (!sampled.ok() || !sampled->is_coarse || round == kMostRefinements || (*found)->refinement->is_over) return sampled;
    absl::Status refined = refine(**found, *sampled->curve, sampled->points().size(), point_set->options.density, context);
    if (!refined.ok()) return refined;
  }
}

absl::StatusOr<ScatteredPoints> LocalSurface::scatter(const v1::SampleRequest& request, const ExecutionContext& context) const {
  const absl::StatusOr<server::ScatterRequest> wanted = server::to_scatter_request(request, options_.crease_degrees);
  if (!wanted.ok()) return wanted.status();
  return scatter_mesh(*loaded_, wanted->scatter, context);
}

absl::StatusOr<std::vector<v1::RemeshResponse>> LocalSurface::remesh(const v1::RemeshRequest& request,
                                                                     const ExecutionContext& context) {
  const absl::StatusOr<server::PointSetRequest> point_set = server::to_point_set_request(request.sample());
  if (!point_set.ok()) return point_set.status();
  const absl::StatusOr<RemeshOptions> options = server::to_remesh_options(request);
  if (!options.ok()) return options.status();
  const absl::StatusOr<std::shared_ptr<const server::Session>> found = session(*point_set, context);
  if (!found.ok()) return found.status();
  const absl::StatusOr<server::SessionMesh> mesh = server::make_session_mesh(**found, *point_set, *options, cache_, context);
  if (!mesh.ok()) return mesh.status();
  std::vector<v1::RemeshResponse> responses;
  absl::Status made = server::make_mesh_chunks(*mesh, *(*found)->curve(), [&responses](v1::RemeshResponse response) {
    responses.push_back(std::move(response));
    return true;
  });
  if (!made.ok()) return made;
  return responses;
}

absl::StatusOr<v1::Measures> LocalSurface::measure(const v1::MeasureRequest& request, std::span<const std::vector<Vec3d>> sets,
                                                   const ExecutionContext& context) {
  absl::StatusOr<MeasureOptions> options = server::to_measure_options(request);
  if (!options.ok()) return options.status();
  options->scalars = loaded_->attributes.scalars;
  const absl::StatusOr<MeasureReport> report = measure_points(loaded_->mesh, sets, *options, context);
  if (!report.ok()) return report.status();
  return server::to_proto(*report, loaded_->info.box.diagonal());
}

FeaturePoints LocalSurface::features(double degrees, std::size_t points, std::uint64_t seed,
                                     const ExecutionContext& context) const {
  return sample_features(loaded_->mesh, degrees, points, seed, context);
}

absl::StatusOr<std::vector<double>> LocalSurface::distances(std::span<const Vec3d> points, const ExecutionContext& context) {
  std::vector<double> found(points.size());
  const MutexLock lock(measuring_);
  if (!distance_) {
    absl::StatusOr<SignedDistance> made = SignedDistance::of(loaded_->mesh);
    if (!made.ok()) return made.status();
    distance_ = *std::move(made);
  }
  absl::Status status = distance_->find(points, found, context);
  if (!status.ok()) return status;
  return found;
}

absl::StatusOr<v1::PointFrame> LocalSurface::frame(const v1::SampleRequest& request,
                                                   std::shared_ptr<const server::ReferenceFrame>& reference,
                                                   const ExecutionContext& context) {
  const absl::StatusOr<server::PointSetRequest> point_set = server::to_streamed_request(request);
  if (!point_set.ok()) return point_set.status();
  if (point_set->automatic) return absl::InvalidArgumentError("a budget in seconds is for what is sent");
  const absl::StatusOr<std::shared_ptr<const server::Session>> found = session(*point_set, context);
  if (!found.ok()) return found.status();
  const server::Session& session = **found;
  for (int round = 0;; ++round) {
    Lacking lacking;
    const server::ImprovementRequests improvements{
        .finer_curve =
            [&](const SurfaceCurve& /*curve*/, std::uint64_t points) {
              lacking.points = round < kMostRefinements && !session.refinement->is_over ? points : 0;
              return lacking.points > 0;
            },
        .more_ranks =
            [&](server::RankDemand demand) {
              lacking.ranks = std::move(demand);
              return true;
            }};
    lacking.curve = session.curve();
    absl::StatusOr<server::Answer> answer = server::make_frame(
        session, {.point_set = *point_set, .reference = reference.get(), .context = context}, cache_, improvements);
    if (!answer.ok()) return answer.status();
    if (lacking.points == 0 && !lacking.ranks) {
      reference = std::move(answer->reference);
      return std::move(answer->frame);
    }
    if (lacking.points > 0) {
      absl::Status refined = refine(session, *lacking.curve, lacking.points, point_set->options.density, context);
      if (!refined.ok()) return refined;
    }
    if (lacking.ranks) {
      absl::Status grown = grow(session, lacking.ranks, context);
      if (!grown.ok()) return grown;
    }
  }
}

}  // namespace curvecast::python
