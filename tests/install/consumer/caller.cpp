// Says how many sessions a server has, with no more than the proto:  caller localhost:50051
#include <curvecast/v1/curvecast.grpc.pb.h>
#include <grpcpp/grpcpp.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const auto server = curvecast::v1::CurvecastService::NewStub(grpc::CreateChannel(argv[1], grpc::InsecureChannelCredentials()));
  grpc::ClientContext context;
  curvecast::v1::ListSessionsResponse sessions;
  const grpc::Status status = server->ListSessions(&context, {}, &sessions);
  if (!status.ok()) {
    std::cerr << status.error_message() << '\n';
    return 1;
  }
  std::cout << sessions.sessions_size() << " sessions\n";
}
