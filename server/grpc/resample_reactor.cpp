// Resample: one point set, packed on a worker and sent block by block.
#include "server/convert/convert.h"
#include "server/frame/point_blocks.h"
#include "server/grpc/held_session.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"

namespace curvecast::server {
namespace {

// The job is the only one that finishes, so the reactor outlives it.
class ResampleReactor final : public WriteQueue<v1::ResampleResponse> {
 public:
  ResampleReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller, const v1::ResampleRequest& request)
      : WriteQueue("Resample", engine, context, caller) {
    begin_with([&] { return begin(engine, request); });
  }

 private:
  absl::Status begin(Engine& engine, const v1::ResampleRequest& request) {
    auto held = HeldSession::hold(engine, request.session_id(), caller());
    if (!held.ok()) return held.status();
    auto point_set = to_point_set_request(request.sample());
    if (!point_set.ok()) return point_set.status();
    if (point_set->automatic)
      return absl::InvalidArgumentError("sample.automatic is for streams; ask for points, bytes or an error in pixels");
    return engine.calls
        .submit(
            [this, &engine, held = *std::move(held), point_set = *std::move(point_set)]() mutable {
              finish(held.answer(engine, [&](const std::shared_ptr<const Session>& session) {
                return answer(engine, *session, point_set, engine.improvement_requests(session, point_set, engine.new_source()));
              }));
            },
            claim())
        .status();
  }

  absl::Status answer(Engine& engine, const Session& session, const PointSetRequest& point_set,
                      const ImprovementRequests& improvements) {
    if (cancelled()) return absl::CancelledError("the client has gone");
    MemoryBudget::Job memory(engine.memory, &cancel_flag());
    return push_all([&](const auto& push_block) {
      return make_point_blocks(session, point_set, engine.view_cache, improvements, {.cancel = &cancel_flag(), .memory = &memory},
                               [&](v1::ResampleResponse block) {
                                 if (block.has_statistics()) engine.metrics.stages(block.statistics());
                                 return push_block(std::move(block));
                               });
    });
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::ResampleResponse>* resample(Engine& engine, grpc::CallbackServerContext& context,
                                                         const Caller& caller, const v1::ResampleRequest& request) {
  return new ResampleReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
