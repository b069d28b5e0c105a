// SPDX-License-Identifier: Apache-2.0
// A view that lives on: frames by callback, over a stream that is opened again when it breaks off.
#pragma once

#include <absl/status/status.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "connection.h"
#include "curvecast/v1/curvecast.pb.h"
#include "view_stream.h"

namespace curvecast::client {

enum class LiveViewState {
  kConnecting,  // at the first look(), and after every wait
  kLive,        // the first frame of a stream has come
  kWaiting,     // the stream broke off, the status says how; it is opened again in a moment
  kEnded,       // for good, the status says why; the last call of all
};

/// Called from a thread of the view's own, one at a time and not before the first look(). They may call look(), and must not
/// throw or destroy the view.
struct LiveViewCallbacks {
  /// A frame taken in. Frame.sequence is what look() gave. One with an error is a view that the server refused: the view lives
  /// on.
  std::function<void(const Frame&)> on_frame;
  std::function<void(LiveViewState, const absl::Status&)> on_state;
};

struct LiveViewOptions {
  bool deltas = true;                              // as in ViewStreamOptions
  std::uint64_t first_bytes = 0;                   // as in ViewStreamOptions
  std::chrono::milliseconds first_delay{100};      // before a broken stream is opened again; doubles until one has lasted
  std::chrono::milliseconds longest_delay{5'000};  // the longest of these; a server that asks for a longer one gets it
};

/// Opens the stream again, goes on from the points that it holds and sends the newest view once more, when the stream ends in a
/// way that may pass: when it is lost (see is_lost) or ended in order, with Aborted, DeadlineExceeded, DataLoss (a frame that
/// cannot be decoded), or ResourceExhausted where the server says when to try again. All else ends the view, as NotFound when the
/// session is no longer there, or Unauthenticated.
/// Thread-safe.
class LiveView {
 public:
  LiveView(std::shared_ptr<Connection> connection, std::string session_id, LiveViewCallbacks callbacks,
           const LiveViewOptions& options = {});
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;
  ~LiveView();  // stops at once, whatever it waits for; a callback that runs is waited for, none comes after

  /// Asks for a view, and returns its number: 1, 2 ... Never blocks. The newest view wins: one that is overtaken gets no frame.
  std::uint64_t look(v1::SampleRequest sample);

 private:
  struct State;
  const std::unique_ptr<State> state_;
};

}  // namespace curvecast::client
