#include "server/web/resources/tileset_making.h"

#include <absl/strings/str_cat.h>
#include <grpcpp/alarm.h>

#include <span>
#include <utility>

#include "server/base/build_info.h"
#include "server/base/grpc_status.h"
#include "server/base/hash.h"
#include "server/base/status_from_exceptions.h"

namespace curvecast::server {
namespace {

using Async = v1::CurvecastService::StubInterface::async_interface;

constexpr auto kPatience = std::chrono::minutes(1);  // for a finer curve
constexpr auto kPoll = std::chrono::milliseconds(50);
constexpr int kMostRounds = 4;              // a density may find the finer curve too coarse again
constexpr std::uint64_t kBytesOfPoint = 3;  // copies of a point's columns: as they come, gathered, and what their division takes

template <class Value>
void update(Hasher& hasher, std::span<const Value> values) {
  hasher.update(absl::StrCat(values.size(), ":"));
  hasher.update({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

/// A name for the tiles of these points: the same ones get the same bytes from the same version of the server.
std::string digest_of(const formats::PointColumns& columns, const formats::TilesetOptions& options) {
  Hasher hasher;
  hasher.update(absl::StrCat(build_info().version, "\n", options.root_points, " ", options.content.quantise, " ",
                             options.content.compress, " ", options.z_up, " ", options.json_levels, "\n"));
  update(hasher, std::span<const double>(columns.origin));
  update(hasher, columns.positions);
  update(hasher, columns.normals);
  update(hasher, columns.colours);
  update(hasher, columns.ranks);
  return hasher.hex();
}

}  // namespace

TilesetMaking::TilesetMaking(std::shared_ptr<WebResource> first, const std::shared_ptr<grpc::Channel>& channel,
                             std::string session_id, TilesetTerms terms, std::string text, Done done)
    : first_(std::move(first)),
      calls_(channel, first_->request().peer, first_->request().request_id),
      session_id_(std::move(session_id)),
      terms_(std::move(terms)),
      text_(std::move(text)),
      done_(std::move(done)),
      deadline_(std::chrono::steady_clock::now() + kPatience) {}

void TilesetMaking::look(Step step) {
  v1::GetSessionRequest request;
  request.set_session_id(session_id_);
  calls_.call<v1::GetSessionRequest, v1::GetSessionResponse>(
      &Async::GetSession, std::move(request),
      [self = shared_from_this(), step](const grpc::Status& status, const v1::GetSessionResponse& found) {
        status.ok() ? self->go_on(step, found.session()) : self->finish(status, nullptr);
      });
}

void TilesetMaking::go_on(Step step, const v1::Session& session) {
  const bool may_wait = rounds_ < kMostRounds;
  if (step == Step::kAwait && session.refining() && std::chrono::steady_clock::now() < deadline_) return await();
  // Of which curve the points are is known only where it was the same before and after them.
  if (step == Step::kCheck && (session.curve_revision() == revision_ || !may_wait)) return submit();
  sample(session.curve_revision());
}

void TilesetMaking::await() {
  // An alarm keeps its callback, and may not be set anew while that runs: each has its own, which lets go of both when it runs.
  auto alarm = std::make_shared<grpc::Alarm>();
  grpc::Alarm& set = *alarm;
  set.Set(std::chrono::system_clock::now() + kPoll,
          [alarm = std::move(alarm), self = shared_from_this()](bool /*whole*/) mutable {
            const auto kept = std::move(alarm);
            const auto making = std::move(self);
            making->look(Step::kAwait);
          });
}

void TilesetMaking::sample(std::uint64_t revision) {
  ++rounds_;
  revision_ = revision;
  points_ = {};
  statistics_ = {};
  memory_.emplace(first_->engine().memory, &calls_.ended(), MemoryTerms{.waits = false});
  request_.set_session_id(session_id_);
  *request_.mutable_sample() = terms_.sample;
  const auto self = shared_from_this();
  auto* const call = new ApiReadCall<v1::ResampleResponse>(
      {self, &calls_}, [self](const v1::ResampleResponse& response) { return self->take(response); },
      [self](const absl::Status& refused, const grpc::Status& status) {
        if (!refused.ok()) return self->fail(refused);
        status.ok() ? self->sampled() : self->finish(status, nullptr);
      });
  calls_.stub().async()->Resample(calls_.introduced(), &request_, call);
  call->start();
}

absl::Status TilesetMaking::take(const v1::ResampleResponse& response) {
  if (absl::Status status = memory_->take(kBytesOfPoint * response.ByteSizeLong(), "the points of tiles"); !status.ok()) {
    return status;
  }
  if (response.has_statistics()) statistics_ = response.statistics();
  return points_.append(response.points());
}

void TilesetMaking::sampled() {
  const bool waits = statistics_.refining() && rounds_ < kMostRounds && std::chrono::steady_clock::now() < deadline_;
  if (!waits) return look(Step::kCheck);
  points_ = {};
  memory_.reset();
  look(Step::kAwait);
}

void TilesetMaking::submit() {
  const Caller& caller = first_->caller();
  const absl::Status submitted = first_->engine()
                                     .calls
                                     .submit(
                                         [self = shared_from_this()] {
                                           const auto made = status_from_exceptions([&] { return self->make_tiles(); });
                                           self->points_ = {};
                                           self->memory_.reset();  // the cache counts what has been made
                                           made.ok() ? self->finish(grpc::Status::OK, *made) : self->fail(made.status());
                                         },
                                         {.caller = caller.name, .connection = caller.address})
                                     .status();
  if (!submitted.ok()) fail(submitted);
}

absl::StatusOr<std::shared_ptr<const Tileset>> TilesetMaking::make_tiles() {
  const formats::PointColumns columns = points_.columns();
  const v1::PointLimit limit = statistics_.limit();
  auto set = std::make_shared<Tileset>();
  set->session_id = session_id_;
  set->terms = text_;
  set->digest = digest_of(columns, terms_.options);
  set->revision = revision_;
  set->is_refining = statistics_.refining();
  set->is_final = !set->is_refining && (limit == v1::POINT_LIMIT_UNSPECIFIED || limit == v1::POINT_LIMIT_DENSITY);
  formats::TilesetOptions options = terms_.options;
  options.folder = absl::StrCat("tiles/", TilesetAddress{set->digest, text_}.part(), "/");
  absl::Status made = formats::make_tileset(columns, options, [&](formats::TileFile file) -> absl::Status {
    if (calls_.ended()) return absl::CancelledError("the client has gone");
    if (absl::Status status = memory_->take(file.bytes.capacity(), "the tiles of a session"); !status.ok()) return status;
    set->files.emplace(std::move(file.name), std::move(file.bytes));
    return absl::OkStatus();
  });
  if (!made.ok()) return made;
  return set;
}

void TilesetMaking::fail(const absl::Status& status) { finish(to_grpc(status), nullptr); }

void TilesetMaking::finish(const grpc::Status& status, const std::shared_ptr<const Tileset>& set) {
  if (const Done done = std::exchange(done_, nullptr)) done(*this, status, set);
}

}  // namespace curvecast::server
