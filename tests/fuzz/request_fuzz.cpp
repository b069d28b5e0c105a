// What a server takes from a client: the converters of every request, and conversations of any messages.
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "server/convert/convert.h"
#include "server/convert/convert_measure.h"
#include "server/frame/client_stream.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_input.h"

namespace curvecast::fuzzing {
namespace {

const google::protobuf::LogSilencer no_log;  // of each text that is no UTF-8

void expect_refused(const absl::Status& status) {
  expect(status.ok() || absl::IsInvalidArgument(status) || absl::IsOutOfRange(status), status.ToString());
}

/// A client's messages, answered by a server that has no mesh: what it holds must stay small, and it must end in order.
class Conversation : public server::ClientStream::Transport {
 public:
  void send(v1::StreamViewsResponse) override {
    expect(!sending_ && !ended_, "a frame out of order");
    sending_ = true;
  }
  void end(const absl::Status&) override {
    expect(!sending_ && !ended_, "an end out of order");
    ended_ = true;
  }

  void receive(const v1::StreamViewsRequest& request) {
    stream_->receive(request);
    run();
  }
  void run() {
    while (sending_ || !jobs_.empty()) {
      if (!jobs_.empty()) {
        const auto job = std::move(jobs_.front());
        jobs_.pop_front();
        job();
      }
      if (sending_) {
        sending_ = false;
        stream_->sent(true);
      }
    }
    expect(queued_ == 0, "frames that nobody counts");
  }
  void finish() {
    stream_->half_close();
    run();
    expect(ended_, "no end");
  }

 private:
  static absl::StatusOr<server::Answer> answer(const server::FrameRequest& request) {
    server::Answer answer;
    answer.frame.set_kind(request.reference != nullptr ? v1::FRAME_KIND_DELTA : v1::FRAME_KIND_KEY);
    answer.reference = std::make_shared<const server::ReferenceFrame>();
    return answer;
  }

  bool sending_ = false, ended_ = false;
  std::int64_t queued_ = 0;
  std::deque<std::function<void()>> jobs_;
  std::shared_ptr<server::ClientStream> stream_ = std::make_shared<server::ClientStream>(
      this, server::ClientStream::Hooks{
                .find =
                    [](const std::string&) {
                      return absl::StatusOr<std::shared_ptr<const server::Session>>(std::make_shared<const server::Session>());
                    },
                .answer = [](const auto&, const server::FrameRequest& request) { return answer(request); },
                .restore = [](const auto&, const auto&,
                              const auto&) { return absl::StatusOr<std::shared_ptr<const server::ReferenceFrame>>(nullptr); },
                .has_room = [] { return absl::OkStatus(); },
                .submit =
                    [this](std::function<void()> job, std::chrono::nanoseconds) {
                      jobs_.push_back(std::move(job));
                      expect(jobs_.size() == 1, "more than one view is answered at a time");
                      return absl::OkStatus();
                    },
                .count_queued = [this](std::int64_t bytes) { queued_ += bytes; },
            });
};

template <class Message, class Convert>
void convert(const std::string& bytes, const Convert& to) {
  Message message;
  if (message.ParseFromString(bytes)) expect_refused(to(message).status());
}

}  // namespace
}  // namespace curvecast::fuzzing

/// Messages, each after its length as a varint: of a conversation, and each also as every other request.
void curvecast::fuzzing::take_input(const std::uint8_t* data, std::size_t size) {
  google::protobuf::io::CodedInputStream input(data, static_cast<int>(size));
  Conversation conversation;
  std::uint32_t length = 0;
  while (input.ReadVarint32(&length)) {
    std::string bytes;
    if (!input.ReadString(&bytes, static_cast<int>(std::min<std::uint32_t>(length, 1 << 20)))) break;
    v1::StreamViewsRequest request;
    if (request.ParseFromString(bytes)) conversation.receive(request);
    convert<v1::SampleRequest>(bytes, server::to_point_set_request);
    convert<v1::SessionOptions>(bytes, server::to_preprocess_options);
    convert<v1::MeasureRequest>(bytes, server::to_measure_options);
  }
  conversation.finish();
}
