// SPDX-License-Identifier: Apache-2.0
// gRPC's standard health service, grpc.health.v1.Health.
#pragma once

#include <absl/status/statusor.h>
#include <google/protobuf/wrappers.pb.h>
#include <grpcpp/generic/generic_stub.h>

#include <memory>
#include <utility>

#include "client/lib/connection.h"

namespace curvecast::client {

class HealthStub {
 public:
  explicit HealthStub(std::shared_ptr<grpc::ChannelInterface> channel) : stub_(std::move(channel)) {}

  /// See Connection::check_health().
  absl::StatusOr<Health> check(grpc::ClientContext* context);

 private:
  // The wrappers have the bytes of HealthCheckRequest (`string service = 1`) and HealthCheckResponse (an enumeration in field 1),
  // whose definitions come with no package.
  grpc::TemplatedGenericStub<google::protobuf::StringValue, google::protobuf::Int32Value> stub_;
};

}  // namespace curvecast::client
