// A call of StreamViews without a server.
#pragma once

#include <absl/status/status.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "client/lib/connection.h"
#include "tests/client/sphere_points.h"

namespace curvecast::client {

/// The server's end of a call.
struct FakeServer {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<v1::StreamViewsResponse> frames;
  std::vector<v1::StreamViewsRequest> requests;
  bool stalled = false;  // nothing that is written gets through
  bool ended = false;
  absl::Status end_status;

  void push(const v1::PointFrame& frame) {
    const std::lock_guard lock(mutex);
    *frames.emplace_back().mutable_frame() = frame;
    changed.notify_all();
  }
  void end(absl::Status status) {
    const std::lock_guard lock(mutex);
    if (!ended) end_status = std::move(status);
    ended = true;
    changed.notify_all();
  }
  void stall(bool is_stalled) {
    const std::lock_guard lock(mutex);
    stalled = is_stalled;
    changed.notify_all();
  }
  /// The message that the client wrote as number `index`, once it is there; an empty one if it does not come.
  v1::StreamViewsRequest request(std::size_t index) {
    std::unique_lock lock(mutex);
    const bool came = changed.wait_for(lock, std::chrono::seconds(60), [&] { return requests.size() > index; });
    return came ? requests[index] : v1::StreamViewsRequest();
  }
  std::vector<std::uint64_t> acks() {
    const std::lock_guard lock(mutex);
    std::vector<std::uint64_t> sequences;
    for (const auto& request : requests) {
      if (request.has_ack()) sequences.push_back(request.ack().sequence());
    }
    return sequences;
  }
};

class FakeViewCall : public ViewCall {
 public:
  explicit FakeViewCall(std::shared_ptr<FakeServer> server) : server_(std::move(server)) {}
  bool write(const v1::StreamViewsRequest& request) override {
    std::unique_lock lock(server_->mutex);
    server_->changed.wait(lock, [&] { return server_->ended || !server_->stalled; });
    if (server_->ended) return false;
    server_->requests.push_back(request);
    server_->changed.notify_all();
    return true;
  }
  bool read(v1::StreamViewsResponse* response) override {
    std::unique_lock lock(server_->mutex);
    server_->changed.wait(lock, [&] { return server_->ended || !server_->frames.empty(); });
    if (server_->frames.empty()) return false;
    *response = std::move(server_->frames.front());
    server_->frames.pop_front();
    return true;
  }
  void writes_done() override { server_->end(absl::OkStatus()); }
  void cancel() override { server_->end(absl::CancelledError("cancelled")); }
  absl::Status finish() override { return server_->end_status; }

 private:
  std::shared_ptr<FakeServer> server_;
};

inline v1::PointFrame key_frame(std::uint64_t sequence, std::size_t points) {
  v1::PointFrame frame;
  frame.set_sequence(sequence);
  frame.set_curve_revision(3);
  frame.set_kind(v1::FRAME_KIND_KEY);
  *frame.add_points() = raw_block(sphere_points(points));
  frame.mutable_statistics()->set_curve_vertices(99);
  return frame;
}

}  // namespace curvecast::client
