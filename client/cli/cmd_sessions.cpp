#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "client/cli/commands.h"

namespace curvecast::cli {
namespace {

struct Flags {
  std::vector<std::string> close, pin, unpin;
};

std::string state_name(const v1::Session& session) {
  switch (session.state()) {
    case v1::SESSION_STATE_QUEUED:
      return "queued";
    case v1::SESSION_STATE_PREPROCESSING:
      return "preprocessing";
    case v1::SESSION_STATE_READY:
      return session.refining() ? "refining" : "ready";
    default:
      return "unknown";
  }
}

Json session_json(const v1::Session& session) {
  return {{"session_id", session.session_id()},           {"mesh_id", session.mesh_id()},
          {"mesh", session.report().mesh().name()},       {"state", state_name(session)},
          {"max_points", session.options().max_points()}, {"curve_vertices", session.report().curve_vertices()},
          {"memory_bytes", session.memory_bytes()},       {"pinned", session.pinned()},
          {"time_to_live", session.time_to_live()},       {"cached", session.cached()}};
}

std::string session_text(const v1::Session& session) {
  return absl::StrFormat("%s  %-13s %8.1f MiB %10d points  %s%s%s\n", session.session_id(), state_name(session),
                         static_cast<double>(session.memory_bytes()) / (1 << 20), session.options().max_points(),
                         session.report().mesh().name(), session.pinned() ? "  pinned" : "", session.cached() ? "  cached" : "");
}

absl::Status pin(client::Client& client, const std::string& id, bool pinned, const std::stop_token& stop) {
  v1::UpdateSessionRequest request;
  request.set_session_id(id);
  request.set_pinned(pinned);
  return client.update_session(request, stop).status();
}

absl::Status run(const Flags& flags, const CommonOptions& options, std::stop_token stop) {
  if (options.server.empty()) return absl::InvalidArgumentError("sessions are a server's: give --server HOST:PORT");
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options);
  if (!host.ok()) return host.status();
  client::Client& client = (*host)->client();
  for (const std::string& id : flags.pin) {
    if (absl::Status status = pin(client, id, true, stop); !status.ok()) return status;
  }
  for (const std::string& id : flags.unpin) {
    if (absl::Status status = pin(client, id, false, stop); !status.ok()) return status;
  }
  for (const std::string& id : flags.close) {
    if (absl::Status status = client.close_session(id, stop); !status.ok()) return status;
  }
  const absl::StatusOr<std::vector<v1::Session>> sessions = client.list_sessions(stop);
  if (!sessions.ok()) return sessions.status();
  if (options.json) {
    Json list = Json::array();
    for (const v1::Session& session : *sessions) list.push_back(session_json(session));
    return print_json({{"sessions", list}});
  }
  std::string text;
  for (const v1::Session& session : *sessions) text += session_text(session);
  return print_text(text.empty() ? "no sessions in memory\n" : text);
}

}  // namespace

Command add_sessions(CLI::App& root, CommonOptions& options) {
  CLI::App* app =
      add_command(root, options, "sessions",
                  "The sessions that a server has in memory, after they have been pinned, unpinned or closed as asked.",
                  {"curvecast sessions --server localhost:50051", "curvecast sessions --server localhost:50051 --pin ID",
                   "curvecast sessions --server localhost:50051 --close ID --json"});
  const auto flags = std::make_shared<Flags>();
  const auto add = [&](const std::string& name, std::vector<std::string>& ids, const std::string& help) {
    app->add_option(name, ids, help)->type_name("ID")->allow_extra_args(false);
  };
  add("--pin", flags->pin, "a session to keep in memory, however many others are used; repeat for more");
  add("--unpin", flags->unpin, "a session that may go again when it has not been used for longest");
  add("--close", flags->close, "a session to forget, in memory and in the server's cache");
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
