// SPDX-License-Identifier: Apache-2.0
// A conversation with a session: views out, frames in.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "connection.h"
#include "curvecast/v1/curvecast.pb.h"
#include "points.h"

namespace curvecast::client {

struct Frame {
  std::uint64_t sequence = 0;  // of the view that it answers; the same again when an improved frame follows by itself
  std::uint64_t curve_revision = 0;
  std::shared_ptr<const Points> points;  // all that there are now; with an error those of the frame before
  bool is_delta = false;                 // it changed the points of the frame before: so many came, went, have another disc
  std::size_t added = 0, removed = 0, resized = 0;  // a key frame removes all and adds all
  v1::FrameStatistics statistics;
  std::uint64_t encoded_bytes = 0;  // of the points and edits on the wire
  double decode_seconds = 0;
  absl::Status error;  // why the server refused the view, see also retry_after(); the stream goes on
};

/// What is left of a stream that broke off, for the next one to go on from.
struct HeldFrame {
  std::shared_ptr<const Points> points = std::make_shared<const Points>();
  v1::SampleRequest sample;  // that the frame answered
  std::uint64_t digest = 0;  // the server's name for the points; 0: it has none
};

struct ViewStreamOptions {
  bool deltas = true;             // frames may be differences to the one before; next_frame() takes them in
  std::uint64_t first_bytes = 0;  // with deltas: larger frames come in parts, one of about so many bytes first; 0 = whole
  HeldFrame held = {};            // with deltas: ViewStream::held() of a stream of the same session that broke off
};

/// Thread-safe, but a frame goes to one caller of next_frame() only.
class ViewStream {
 public:
  /// Opens the stream; a server that refuses says so in the first next_frame(). `stop` ends the stream with Cancelled.
  static std::unique_ptr<ViewStream> open(Connection& connection, const std::string& session_id, std::stop_token stop = {},
                                          const ViewStreamOptions& options = {});
  ViewStream(const ViewStream&) = delete;
  ViewStream& operator=(const ViewStream&) = delete;
  ~ViewStream();  // closes at once

  /// Asks for a view and returns its sequence number: `sequence`, or the next one where that is 0. The newest view wins: one that
  /// is overtaken gets no frame. With `key_frame` its frame, or that of the view that overtakes it, replaces all points. After
  /// the stream's end, its status. InvalidArgument: not above the numbers before.
  absl::StatusOr<std::uint64_t> send_view(const v1::SampleRequest& sample, bool key_frame = false, std::uint64_t sequence = 0);

  /// Waits for the next frame, acknowledges it, and decodes it. DeadlineExceeded after `timeout`, DataLoss for a frame that
  /// cannot be decoded (deltas after it cannot be taken in until a key frame comes), Aborted when the server has ended the stream
  /// in order, else the status it ended with.
  absl::StatusOr<Frame> next_frame(std::chrono::milliseconds timeout);

  /// The points of the last frame taken in, for the stream after this one; without a digest where the server gave none.
  HeldFrame held() const;

  /// Sends no more, waits for the server to end the stream and returns its status. Frames not taken are dropped.
  absl::Status close();

 private:
  struct State;
  explicit ViewStream(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace curvecast::client
