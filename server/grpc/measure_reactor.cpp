// Measure: measures uploaded points on a mesh, and another mesh, and tells how far it is.
#include <absl/strings/str_cat.h>

#include <optional>

#include "server/base/grpc_status.h"
#include "server/base/protocol.h"
#include "server/base/status_from_exceptions.h"
#include "server/convert/convert_measure.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"
#include "server/session/expected_time.h"
#include "server/session/mesh_files.h"

namespace curvecast::server {
namespace {

struct Work {
  MeshFiles mesh;
  std::optional<MeshFiles> other;
  std::vector<std::shared_ptr<const Mesh>> points;
  MeasureOptions options;
  HausdorffOptions distance;
  v1::MeasureRequest request;
};

// The job is the only one that finishes, so the reactor outlives it. It queues with the preprocessing jobs, for it takes all
// cores as well.
class MeasureReactor final : public WriteQueue<v1::MeasureResponse> {
 public:
  MeasureReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller, const v1::MeasureRequest& request)
      : WriteQueue("Measure", engine, context, caller) {
    begin_with_meshes(engine, [this, &engine, &request] { return begin(engine, request); });
  }

 private:
  absl::Status begin(Engine& engine, const v1::MeasureRequest& request) {
    auto mesh = find_files(engine.meshes, request.mesh_id(), request.companions(), caller().owner);
    if (!mesh.ok()) return mesh.status();
    const bool has_other = !request.other_mesh_id().empty();
    if (request.sets_size() < (has_other ? 0 : 1) || request.sets_size() > kMaxMeasuredSets) {
      return absl::InvalidArgumentError(absl::StrCat("sets has ", request.sets_size(), " entries; it must have 1 to ",
                                                     kMaxMeasuredSets, ", or none where there is another mesh"));
    }
    const auto options = to_measure_options(request);
    if (!options.ok()) return options.status();
    const auto distance = to_hausdorff_options(request);
    if (!distance.ok()) return distance.status();
    Work work{*std::move(mesh), std::nullopt, {}, *options, *distance, request};
    if (has_other) {
      auto other = find_files(engine.meshes, request.other_mesh_id(), request.other_companions(), caller().owner);
      if (!other.ok()) return other.status();
      work.other = *std::move(other);
    }
    for (const v1::UploadedPoints& set : request.sets()) {
      auto file = engine.meshes.find(set.points_id(), caller().owner);
      if (!file.ok()) return file.status();
      work.points.push_back(*std::move(file));
    }
    std::uint64_t bytes = work.mesh.mesh->size() + (work.other.has_value() ? work.other->mesh->size() : 0);
    for (const auto& points_file : work.points) bytes += points_file->size();
    const auto expected = expected_time(bytes, {});
    push_progress("queued", 0);
    return engine.preprocessing
        .submit([this, work = std::move(work),
                 &engine] { finish(to_grpc(status_from_exceptions([&] { return answer(work, engine); }))); },
                claim(expected))
        .status();
  }

  absl::Status answer(const Work& work, Engine& engine) {
    MemoryBudget::Job memory(engine.memory, &cancel_flag());
    ExecutionContext context;
    context.cancel = &cancel_flag();
    context.memory = &memory;
    context.threads = engine.threads;
    context.on_progress = [this](std::string_view stage, double fraction) { push_progress(stage, fraction); };
    for (const std::shared_ptr<const Mesh>& points : work.points) {
      if (absl::Status opened = points->open(context); !opened.ok()) return opened;
    }
    const auto sets = to_point_sets(work.request, work.points);
    for (const std::shared_ptr<const Mesh>& points : work.points) {
      if (absl::Status status = points->status(); !status.ok()) return status;
    }
    if (!sets.ok()) return sets.status();
    const auto mesh = load_mesh(work.mesh, context);
    if (!mesh.ok()) return mesh.status();
    v1::MeasureResponse response;
    const double diagonal = mesh->info.box.diagonal();
    if (!sets->empty()) {
      MeasureOptions options = work.options;
      options.scalars = mesh->attributes.scalars;
      const auto report = measure_points(mesh->mesh, *sets, options, context);
      if (!report.ok()) return report.status();
      *response.mutable_measures() = to_proto(*report, diagonal);
    }
    if (work.other) {
      const auto other = load_mesh(*work.other, context);
      if (!other.ok()) return other.status();
      const HausdorffDistance distance = hausdorff_distance(mesh->mesh, other->mesh, work.distance, context);
      if (absl::Status status = context.check(); !status.ok()) return status;
      *response.mutable_measures()->mutable_distance() = to_proto(distance, diagonal);
    }
    push(std::move(response));
    return absl::OkStatus();
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::MeasureResponse>* measure(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                                       const v1::MeasureRequest& request) {
  return new MeasureReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
