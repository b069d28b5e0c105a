// A stream of views on a server, whatever carries it: admitted, counted, and slowed down to the rate that is allowed.
#pragma once

#include <absl/status/statusor.h>
#include <grpcpp/alarm.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/mutex.h"
#include "server/base/admission.h"
#include "server/base/rate_limit.h"
#include "server/engine/caller.h"
#include "server/engine/engine.h"
#include "server/engine/view_tally.h"
#include "server/frame/client_stream.h"

namespace curvecast::server {

/// Belongs to one transport. receive() is called for one message at a time; the other functions by any thread.
class ViewConversation {
 public:
  /// Begins a conversation with an open stream, which ends when its caller may call no more. The caller's connections share its
  /// part of the workers, the streams of a connection that connection's. ResourceExhausted: there are too many streams.
  /// Unavailable: the server shuts down.
  static absl::StatusOr<std::unique_ptr<ViewConversation>> begin(Engine& engine, ClientStream::Transport* transport,
                                                                 const Caller& caller);

  ClientStream& stream() { return *stream_; }

  /// Passes a message to the stream, and calls `on_received` once the next message may come, as the last thing: within the call,
  /// or later on another thread. Until then the request and the conversation must stay where they are.
  void receive(const v1::StreamViewsRequest& request, std::function<void()> on_received) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Ends the pause after a message at once, and makes no more pauses: the stream is over.
  void end_pause() ABSL_LOCKS_EXCLUDED(mutex_);
  /// Makes room for another stream, so that a client that hears of the end may begin again at once. Called once, when no message
  /// is being received.
  void release_admission() { ticket_.reset(); }
  /// Counts a message that is about to be sent.
  void count_sent(const v1::StreamViewsResponse& response);

 private:
  ViewConversation(Engine& engine, const Caller& caller, Admission::Ticket ticket, std::shared_ptr<ClientStream> stream);
  /// Lets the next message come after a pause.
  void resume() ABSL_LOCKS_EXCLUDED(mutex_);

  Engine& engine_;
  const std::string owner_;  // as of Caller
  std::optional<Admission::Ticket> ticket_;
  const std::shared_ptr<ClientStream> stream_;
  const CallerWatch::Ticket watched_;
  ViewTally tally_;
  RateLimit rate_;
  Mutex mutex_;
  bool is_over_ ABSL_GUARDED_BY(mutex_) = false;
  std::function<void()> on_received_ ABSL_GUARDED_BY(mutex_);  // of the message that a pause follows; null: there is no pause
  grpc::Alarm alarm_;
};

}  // namespace curvecast::server
