// FindNeighbours: a session's points, packed on a worker and sent block by block, then the neighbours of each.
#include "server/convert/convert.h"
#include "server/frame/session_neighbours.h"
#include "server/grpc/held_session.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"

namespace curvecast::server {
namespace {

// The job is the only one that finishes, so the reactor outlives it.
class NeighboursReactor final : public WriteQueue<v1::FindNeighboursResponse> {
 public:
  NeighboursReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                    const v1::FindNeighboursRequest& request)
      : WriteQueue("FindNeighbours", engine, context, caller) {
    begin_with([&] { return begin(engine, request); });
  }

 private:
  absl::Status begin(Engine& engine, const v1::FindNeighboursRequest& request) {
    auto held = HeldSession::hold(engine, request.session_id(), caller());
    if (!held.ok()) return held.status();
    auto points = to_point_set_request(request.sample());
    if (!points.ok()) return points.status();
    if (points->automatic || points->max_bytes > 0) {
      return absl::InvalidArgumentError("sample has a budget in bytes or time; ask for points or an error in pixels");
    }
    const auto search = to_neighbour_search(request);
    if (!search.ok()) return search.status();
    return engine.calls
        .submit(
            [this, &engine, held = *std::move(held), points = *std::move(points), search = *search]() mutable {
              finish(held.answer(engine, [&](const std::shared_ptr<const Session>& session) {
                return answer(engine, session, points, search);
              }));
            },
            claim())
        .status();
  }

  absl::Status answer(Engine& engine, const std::shared_ptr<const Session>& session, const PointSetRequest& points,
                      const NeighbourSearch& search) {
    if (cancelled()) return absl::CancelledError("the client has gone");
    MemoryBudget::Job memory(engine.memory, &cancel_flag());
    ExecutionContext context;
    context.cancel = &cancel_flag();
    context.memory = &memory;
    context.on_progress = [this](std::string_view stage, double fraction) { push_progress(stage, fraction); };
    const ImprovementRequests improvements = engine.improvement_requests(session, points, engine.new_source());
    return push_all([&](const auto& push_message) {
      return find_neighbours(*session, points, search, engine.view_cache, improvements, context,
                             [&](v1::FindNeighboursResponse message) {
                               if (message.points().has_statistics()) engine.metrics.stages(message.points().statistics());
                               return push_message(std::move(message));
                             });
    });
  }

  bool replaces(const v1::FindNeighboursResponse& newer, const v1::FindNeighboursResponse& older) const override {
    return newer.has_progress() && older.has_progress();
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::FindNeighboursResponse>* find_neighbours(Engine& engine, grpc::CallbackServerContext& context,
                                                                      const Caller& caller,
                                                                      const v1::FindNeighboursRequest& request) {
  return new NeighboursReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
