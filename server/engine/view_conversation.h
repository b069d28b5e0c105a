// A stream of views as the server sees it, whatever carries it: admitted, counted, and held to its rate.
#pragma once

#include <absl/status/statusor.h>
#include <grpcpp/alarm.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "server/base/admission.h"
#include "server/base/rate_limit.h"
#include "server/engine/engine.h"
#include "server/engine/view_tally.h"
#include "server/frame/client_stream.h"

namespace curvecast::server {

/// Begun and given messages by one transport, one message at a time.
class ViewConversation {
 public:
  /// `caller` as of caller_of(), `peer` shares the workers with the others. ResourceExhausted where there are too many,
  /// Unavailable while the server shuts down.
  static absl::StatusOr<std::unique_ptr<ViewConversation>> begin(Engine& engine, ClientStream::Transport* transport,
                                                                 const std::string& caller, const std::string& peer);

  ClientStream& stream() { return *stream_; }

  /// Takes a message in, and calls `on_taken` once the next one may come, as the last thing: within the call, or later on another
  /// thread. Until then the request and this stay where they are.
  void take(const v1::StreamViewsRequest& request, std::function<void()> on_taken);
  /// A pause that a message is held to ends at once; there are no others. The stream is over.
  void end_pause();
  /// Counts no more, so that who hears of the end may begin again at once. Called once, when nothing is taken in any more.
  void leave() { ticket_.reset(); }
  /// A message that is about to be sent.
  void count(const v1::StreamViewsResponse& response);

 private:
  ViewConversation(Engine& engine, Admission::Ticket ticket, std::shared_ptr<ClientStream> stream);
  /// A pause is over.
  void go_on();

  Engine& engine_;
  std::optional<Admission::Ticket> ticket_;
  const std::shared_ptr<ClientStream> stream_;
  ViewTally tally_;
  RateLimit rate_;
  std::mutex mutex_;
  bool is_over_ = false;
  std::function<void()> on_taken_;  // of the message that a pause follows; null: there is no pause
  grpc::Alarm alarm_;
};

}  // namespace curvecast::server
