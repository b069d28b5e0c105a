#include "server/frame/send_window.h"

#include <utility>

namespace curvecast::server {

void SendWindow::push(const Frame& frame, v1::StreamViewsResponse response) {
  unacknowledged_.push_back(frame);
  const auto bytes = static_cast<std::int64_t>(response.ByteSizeLong());
  queued_bytes_ += bytes;
  count_queued_(bytes);
  queue_.push_back(std::move(response));
}

v1::StreamViewsResponse SendWindow::begin_send() {
  v1::StreamViewsResponse response = std::move(queue_.front());
  queue_.pop_front();
  is_sending_ = true;
  last_sent_ = response.frame().sequence();
  sending_bytes_ = static_cast<std::int64_t>(response.ByteSizeLong());
  queued_bytes_ -= sending_bytes_;
  return response;
}

void SendWindow::end_send() {
  is_sending_ = false;
  count_queued_(-std::exchange(sending_bytes_, 0));
}

void SendWindow::clear() {
  queue_.clear();
  count_queued_(-std::exchange(queued_bytes_, 0));
}

bool SendWindow::acknowledge(std::uint64_t sequence, const std::function<void(const Frame& frame)>& on_frame) {
  // Taken at its word, an acknowledgement ahead of its frame would let frames pile up for a client that reads none.
  if (!last_sent_ || sequence > *last_sent_) return false;
  // A number may have been sent twice: a frame that is still queued is not meant.
  while (unacknowledged_.size() > queue_.size() && unacknowledged_.front().sequence <= sequence) {
    on_frame(unacknowledged_.front());
    unacknowledged_.pop_front();
  }
  return true;
}

}  // namespace curvecast::server
