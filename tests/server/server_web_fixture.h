// A server whose HTTP port is open, and what browsers send it.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "eventually.h"
#include "has_line.h"
#include "server_fixture.h"
#include "tests/server/web/http_client.h"
#include "tests/server/web/web_socket_client.h"

namespace curvecast::server {

template <class Message>
Message parsed(const std::string& bytes) {
  Message message;
  EXPECT_TRUE(message.ParseFromString(bytes));
  return message;
}

inline v1::CallRequest call_of(std::uint32_t number, const std::string& method,
                               const google::protobuf::MessageLite* message = nullptr) {
  v1::CallRequest request;
  request.set_call(number);
  request.set_method(method);
  if (message != nullptr) request.set_message(message->SerializeAsString());
  return request;
}

class ServerWebSocket : public ServerFixture {
 protected:
  void SetUp() override { start({.http = "127.0.0.1:0"}); }

  WebSocketClient connect_socket(const WebSocketClientOptions& options = {}) const {
    return WebSocketClient(server_->http_port(), options);
  }

  /// Waits until the metrics have that line.
  void wait_for(const std::string& line) const {
    EXPECT_TRUE(eventually([&] { return static_cast<bool>(has_line(metrics(), line)); })) << "the metrics never said " << line;
  }

  static std::string upload_over(WebSocketClient& socket, const std::string& bytes, std::size_t chunk) {
    v1::UploadMeshRequest request;
    request.mutable_header()->set_name("mesh.off");
    request.mutable_header()->set_size(bytes.size());
    std::vector<std::string> messages = {request.SerializeAsString()};
    for (std::size_t at = 0; at < bytes.size(); at += chunk) {
      request.set_chunk(bytes.substr(at, chunk));
      messages.push_back(request.SerializeAsString());
    }
    const auto answer = socket.call("UploadMesh", messages);
    EXPECT_EQ(answer.code, 0) << answer.error;
    return answer.messages.size() == 1 ? parsed<v1::UploadMeshResponse>(answer.messages[0]).mesh_id() : "";
  }

  static v1::Session create_over(WebSocketClient& socket, const std::string& mesh, std::uint64_t points) {
    v1::CreateSessionRequest request;
    request.set_mesh_id(mesh);
    request.mutable_options()->set_max_points(points);
    const auto answer = socket.call("CreateSession", request);
    EXPECT_EQ(answer.code, 0) << answer.error;
    EXPECT_GT(answer.messages.size(), 3u);  // told how far it was
    return parsed<v1::CreateSessionResponse>(answer.messages.back()).session();
  }

  /// A session, made through gRPC.
  std::string make_session() {
    const auto stub = client();
    const Created created = create(*stub, upload(*stub, sphere_off(4)), 2000);
    EXPECT_TRUE(created.status.ok()) << created.status.error_message();
    return created.session.session_id();
  }
};

inline v1::StreamViewsRequest open_of(const std::string& session, bool accepts_deltas = false) {
  v1::StreamViewsRequest request;
  request.mutable_open()->set_session_id(session);
  request.mutable_open()->set_accept_deltas(accepts_deltas);
  return request;
}

inline v1::StreamViewsRequest view_message(std::uint64_t sequence, const v1::SampleRequest& sample) {
  v1::StreamViewsRequest request;
  request.mutable_view()->set_sequence(sequence);
  *request.mutable_view()->mutable_sample() = sample;
  return request;
}

inline v1::StreamViewsRequest ack_of(std::uint64_t sequence) {
  v1::StreamViewsRequest request;
  request.mutable_ack()->set_sequence(sequence);
  return request;
}

}  // namespace curvecast::server
