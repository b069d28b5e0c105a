// A session that a call uses later, on a worker.
#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <string>
#include <utility>

#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/engine/caller.h"
#include "server/engine/engine.h"

namespace curvecast::server {

/// What is in memory is held from now on, whoever closes it; what has to be loaded is left to the worker.
class HeldSession {
 public:
  /// Errors as of SessionStore::find() for what is in memory.
  static absl::StatusOr<HeldSession> hold(Engine& engine, const std::string& id, const Caller& caller) {
    HeldSession held(id, caller.owner);
    if (engine.sessions.must_load(id)) return held;
    absl::StatusOr<std::shared_ptr<const Session>> session = engine.sessions.find(id, caller.owner);
    if (!session.ok()) return session.status();
    held.session_ = *std::move(session);
    return held;
  }

  /// What a call's job ends with: `use` answers with the session, which is loaded where that is still to be done, and let go of
  /// before the client hears that the call is done. Exceptions become errors.
  template <typename Use>
  grpc::Status answer(Engine& engine, const Use& use) {
    return to_grpc(status_from_exceptions([&]() -> absl::Status {
      const absl::StatusOr<std::shared_ptr<const Session>> session = take(engine);
      if (!session.ok()) return session.status();
      const absl::Status used = use(*session);
      const absl::Status checked = engine.sessions.check(**session);
      return checked.ok() ? used : checked;
    }));
  }

 private:
  /// Gives the session away, after loading it where that is still to be done: may wait for the disk.
  absl::StatusOr<std::shared_ptr<const Session>> take(Engine& engine) {
    if (session_ == nullptr) return engine.sessions.find(id_, who_);
    return std::move(session_);
  }

  HeldSession(std::string id, std::string who) : id_(std::move(id)), who_(std::move(who)) {}

  std::string id_, who_;
  std::shared_ptr<const Session> session_;  // null: it has to be loaded
};

}  // namespace curvecast::server
