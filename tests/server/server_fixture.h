// A real server on a free port of the loopback, and clients that talk to it over TCP.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "curvecast/v1/curvecast.grpc.pb.h"
#include "server/server.h"
#include "tests/server/has_line.h"

namespace curvecast::server {

/// A unit sphere of 8 * 4^levels triangles as an OFF file.
std::string sphere_off(int levels);

using Stub = v1::CurvecastService::StubInterface;

std::string address_of(const Server& server);
/// With a connection of its own.
std::shared_ptr<grpc::Channel> connect_to(const Server& server);
/// What its page for Prometheus says, on whichever of its ports has it.
std::string metrics_of(const Server& server);
/// Sends such metadata with every call.
std::unique_ptr<Stub> client_sending(const Server& server, const std::string& key, const std::string& value);

class ServerFixture : public ::testing::Test {
 protected:
  void SetUp() override { start({}); }
  void start(ServerOptions options);
  std::string address() const;
  /// Each with a connection of its own.
  std::shared_ptr<grpc::Channel> connect() const;
  std::unique_ptr<Stub> client() const { return v1::CurvecastService::NewStub(connect()); }
  /// Sends a token with every call.
  std::unique_ptr<Stub> client_with(const std::string& token) const { return client_sending("authorization", "Bearer " + token); }
  /// Sends such metadata with every call.
  std::unique_ptr<Stub> client_sending(const std::string& key, const std::string& value) const {
    return server::client_sending(*server_, key, value);
  }
  std::string metrics() const { return metrics_of(*server_); }
  /// Of one metric, with its labels.
  double metric(const std::string& name) const { return value_of(metrics(), name); }

  std::unique_ptr<Server> server_;
};

/// Nothing here takes that long unless it hangs.
void set_patience(grpc::ClientContext& context);

struct Uploaded {
  grpc::Status status;
  v1::UploadMeshResponse response;
};
Uploaded upload(Stub& stub, const v1::UploadHeader& header, const std::string& bytes, std::size_t chunk = 10'000);
/// Uploads and returns the id.
std::string upload(Stub& stub, const std::string& bytes);

struct Created {
  grpc::Status status;
  std::vector<v1::Progress> progress;
  v1::Session session;
};
Created create(Stub& stub, const std::string& mesh_id, std::uint64_t max_points,
               const std::map<std::string, std::string>& companions = {});
Created create(Stub& stub, const std::string& mesh_id, const v1::SessionOptions& options,
               const std::map<std::string, std::string>& companions = {});

struct Resampled {
  grpc::Status status;
  std::vector<v1::ResampleResponse> blocks;

  std::uint64_t points() const;
  /// Everything but the times.
  std::string bytes() const;
};
Resampled resample(Stub& stub, const std::string& session_id, const v1::SampleRequest& sample);

/// N points with a silhouette view from (0, 0, 3).
v1::SampleRequest view_of(std::uint64_t points);

}  // namespace curvecast::server
