// A stream of views over TCP, in the test's hands.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "tests/server/server_fixture.h"

namespace curvecast::server {

/// Opens a session, and reads no frame by itself.
struct OpenedStream {
  using Stream = grpc::ClientReaderWriterInterface<v1::StreamViewsRequest, v1::StreamViewsResponse>;

  OpenedStream(Stub& stub, const std::string& session) {
    set_patience(context);
    stream = stub.StreamViews(&context);
    v1::StreamViewsRequest request;
    request.mutable_open()->set_session_id(session);
    stream->Write(request);
  }

  bool ask(std::uint64_t sequence, std::uint64_t points) { return ask(sequence, view_of(points)); }
  bool ask(std::uint64_t sequence, const v1::SampleRequest& sample) {
    v1::StreamViewsRequest request;
    request.mutable_view()->set_sequence(sequence);
    *request.mutable_view()->mutable_sample() = sample;
    return write(request);
  }
  bool acknowledge(std::uint64_t sequence) {
    v1::StreamViewsRequest request;
    request.mutable_ack()->set_sequence(sequence);
    return write(request);
  }
  bool write(const v1::StreamViewsRequest& request) {
    const std::lock_guard lock(mutex);  // gRPC takes one at a time
    return stream->Write(request);
  }
  /// The next frame; empty once the stream has ended.
  v1::PointFrame read() {
    v1::StreamViewsResponse response;
    return stream->Read(&response) ? response.frame() : v1::PointFrame();
  }

  /// Asks for a view and waits until it is answered; the status with which the stream ends instead.
  grpc::Status answer(std::uint64_t sequence = 1) {
    ask(sequence, 10);
    v1::StreamViewsResponse response;
    while (stream->Read(&response)) {
      if (response.frame().sequence() == sequence) return grpc::Status::OK;
    }
    return stream->Finish();
  }

  std::mutex mutex;
  grpc::ClientContext context;
  std::unique_ptr<Stream> stream;
};

}  // namespace curvecast::server
