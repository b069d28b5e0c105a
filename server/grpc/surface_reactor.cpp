// GetSurface: sends a session's mesh as a file of Draco, chunk by chunk.
#include <cstdint>

#include "server/base/protocol.h"
#include "server/convert/convert.h"
#include "server/convert/field_validator.h"
#include "server/frame/surface_file.h"
#include "server/grpc/held_session.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"
#include "server/session/expected_time.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kChunkFileBytes = kMaxChunkBytes - 64;  // with what holds them

// The job is the only one that finishes, so the reactor outlives it. It queues with the preprocessing jobs: it may take a second.
class SurfaceReactor final : public WriteQueue<v1::GetSurfaceResponse> {
 public:
  SurfaceReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller, const v1::GetSurfaceRequest& request)
      : WriteQueue("GetSurface", engine, context, caller) {
    begin_with([&] { return begin(engine, request); });
  }

 private:
  absl::Status begin(Engine& engine, const v1::GetSurfaceRequest& request) {
    FieldValidator check;
    const std::int64_t asked = request.position_bits() == 0 ? kSurfaceBits : request.position_bits();
    const int bits = static_cast<int>(check.in_range<std::int64_t>("position_bits", asked, kLeastSurfaceBits, kMostSurfaceBits));
    if (!check.ok()) return check.status();
    auto held = HeldSession::hold(engine, request.session_id(), caller());
    if (!held.ok()) return held.status();
    return engine.preprocessing
        .submit(
            [this, &engine, held = *std::move(held), bits]() mutable {
              finish(held.answer(engine,
                                 [&](const std::shared_ptr<const Session>& session) { return answer(engine, *session, bits); }));
            },
            claim(expected_surface_time()))
        .status();
  }

  absl::Status answer(Engine& engine, const Session& session, int bits) {
    if (cancelled()) return absl::CancelledError("the client has gone");
    const auto file = engine.surface_files.get(session.id, bits, [&]() -> absl::StatusOr<SurfaceFile> {
      MemoryBudget::Job memory(engine.memory, &cancel_flag());
      ExecutionContext context;
      context.cancel = &cancel_flag();
      context.memory = &memory;
      const auto base = session.surface->base(context);
      if (!base.ok()) return base.status();
      return make_surface_file(**base, session.curve()->origin, bits, context);
    });
    if (!file.ok()) return file.status();
    const double degrees = crease_degrees(session.options, session.preprocessed.report.mesh.crease_degrees);
    return push_all([&](const auto& emit) { return send(**file, degrees, emit); });
  }

  template <typename Emit>
  static absl::Status send(const SurfaceFile& file, double crease_degrees, const Emit& emit) {
    v1::GetSurfaceResponse first;
    v1::SurfaceInfo& info = *first.mutable_info();
    info.set_vertices(file.vertices);
    info.set_triangles(file.triangles);
    info.set_bytes(file.bytes.size());
    *info.mutable_origin() = to_proto(file.origin);
    info.set_crease_degrees(crease_degrees);
    const absl::Status gone = absl::CancelledError("the client has gone");
    if (!emit(std::move(first))) return gone;
    for (std::size_t at = 0; at < file.bytes.size(); at += kChunkFileBytes) {
      v1::GetSurfaceResponse next;
      next.set_chunk(file.bytes.substr(at, kChunkFileBytes));
      if (!emit(std::move(next))) return gone;
    }
    return absl::OkStatus();
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::GetSurfaceResponse>* get_surface(Engine& engine, grpc::CallbackServerContext& context,
                                                              const Caller& caller, const v1::GetSurfaceRequest& request) {
  return new SurfaceReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
