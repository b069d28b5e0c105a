// SPDX-License-Identifier: Apache-2.0
#include "client/lib/health.h"

#include <grpcpp/client_context.h>

#include <future>

#include "client/lib/rpc_status.h"
#include "curvecast/v1/curvecast.grpc.pb.h"

namespace curvecast::client {
namespace {

constexpr char kMethod[] = "/grpc.health.v1.Health/Check";
constexpr int kServing = 1;  // HealthCheckResponse.ServingStatus

}  // namespace

absl::StatusOr<Health> HealthStub::check(grpc::ClientContext* context) {
  google::protobuf::StringValue request;
  request.set_value(v1::CurvecastService::service_full_name());
  google::protobuf::Int32Value response;
  std::promise<grpc::Status> done;
  stub_.UnaryCall(context, kMethod, grpc::StubOptions(), &request, &response,
                  [&](grpc::Status status) { done.set_value(std::move(status)); });
  const absl::Status status = to_absl(done.get_future().get());
  // A server that has health, but no such service, does not know its name.
  if (absl::IsNotFound(status) || absl::IsUnimplemented(status)) {
    return absl::UnimplementedError("it answers, but is no Curvecast server");
  }
  if (!status.ok()) return status;
  return response.value() == kServing ? Health::kServing : Health::kNotServing;
}

}  // namespace curvecast::client
