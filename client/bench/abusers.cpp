#include "client/bench/abusers.h"

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <stop_token>
#include <utility>

#include "client/lib/connection.h"
#include "core/base/mutex.h"
#include "curvecast/v1/curvecast.grpc.pb.h"

namespace curvecast::cli::bench {
namespace {

using std::chrono::milliseconds;
using Stub = v1::CurvecastService::Stub;

constexpr int kLazyStreams = 16;
constexpr std::size_t kChunk = std::size_t{1} << 20;

/// A stream of views that ends when it is told to.
class Stream {
 public:
  Stream(Stub& stub, const std::string& session_id, const std::stop_token& stop)
      : on_stop_(stop, [this] { context_.TryCancel(); }), stream_(stub.StreamViews(&context_)) {
    v1::StreamViewsRequest request;
    request.mutable_open()->set_session_id(session_id);
    stream_->Write(request);
  }
  ~Stream() {
    context_.TryCancel();
    v1::StreamViewsResponse rest;
    while (stream_->Read(&rest)) {
    }
    stream_->Finish();
  }

  bool ask(const v1::SampleRequest& sample) {
    v1::StreamViewsRequest request;
    request.mutable_view()->set_sequence(++sequence_);
    *request.mutable_view()->mutable_sample() = sample;
    return write(request);
  }
  bool take() {
    v1::StreamViewsResponse response;
    if (!stream_->Read(&response)) return false;
    v1::StreamViewsRequest request;
    request.mutable_ack()->set_sequence(response.frame().sequence());
    return write(request);
  }

 private:
  bool write(const v1::StreamViewsRequest& request) {
    const MutexLock lock(mutex_);  // gRPC takes one at a time
    return stream_->Write(request);
  }

  Mutex mutex_;
  grpc::ClientContext context_;
  std::stop_callback<std::function<void()>> on_stop_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::StreamViewsRequest, v1::StreamViewsResponse>> stream_;
  std::uint64_t sequence_ = 0;
};

void upload_for_ever(Stub& stub, const std::stop_token& stop) {
  grpc::ClientContext context;
  const std::stop_callback on_stop(stop, [&] { context.TryCancel(); });
  v1::UploadMeshResponse response;
  const auto writer = stub.UploadMesh(&context, &response);
  v1::UploadMeshRequest request;
  request.mutable_header()->set_size(std::uint64_t{1} << 30);
  bool is_open = writer->Write(request);
  request.set_chunk(std::string(kChunk, 'x'));
  while (is_open && !stop.stop_requested()) {
    is_open = writer->Write(request);
    std::this_thread::sleep_for(milliseconds(20));
  }
  writer->Finish();
}

}  // namespace

Abusers::Abusers(const std::string& address, const std::string& session_id,
                 const std::function<v1::SampleRequest(double)>& view) {
  const auto add = [&](auto&& work) {
    threads_.emplace_back([work, address](const std::stop_token& stop) {
      const std::unique_ptr<Stub> stub = v1::CurvecastService::NewStub(client::tcp_channel(address));
      while (!stop.stop_requested()) work(*stub, stop);
    });
  };
  add([session_id, view](Stub& stub, const std::stop_token& stop) {
    std::vector<std::unique_ptr<Stream>> lazy;
    lazy.reserve(kLazyStreams);
    for (int i = 0; i < kLazyStreams; ++i) lazy.push_back(std::make_unique<Stream>(stub, session_id, stop));
    for (int i = 0; !stop.stop_requested(); ++i) {
      for (const auto& stream : lazy) stream->ask(view(i));
      std::this_thread::sleep_for(milliseconds(100));
    }
  });
  add([session_id, view](Stub& stub, const std::stop_token& stop) {
    Stream flood(stub, session_id, stop);
    std::jthread reader([&] {
      while (flood.take()) {
      }
    });
    for (int i = 0; flood.ask(view(i)); ++i) std::this_thread::sleep_for(std::chrono::microseconds(100));
  });
  add([session_id, view](Stub& stub, const std::stop_token& stop) {
    Stream brief(stub, session_id, stop);
    brief.ask(view(0));
    std::this_thread::sleep_for(milliseconds(5));
  });
  add(upload_for_ever);
}

Abusers::~Abusers() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

}  // namespace curvecast::cli::bench
