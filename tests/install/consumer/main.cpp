// Takes points of a small mesh from a server:  consumer localhost:50051 1000
#include <curvecast/client/client.h>

#include <cstdlib>
#include <iostream>
#include <string_view>

namespace client = curvecast::client;
namespace v1 = curvecast::v1;

constexpr std::string_view kOctahedron =
    "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n"
    "3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n";

absl::Status take(const char* address, std::uint64_t points) {
  client::Client server(client::make_connection(client::tcp_channel(address)));
  const absl::StatusOr<std::string> mesh = server.upload_mesh("octahedron.off", kOctahedron);
  if (!mesh.ok()) return mesh.status();
  v1::SessionOptions options;
  options.set_max_points(points);
  const absl::StatusOr<v1::Session> session = server.create_session(*mesh, options);
  if (!session.ok()) return session.status();
  v1::ResampleRequest request;
  request.set_session_id(session->session_id());
  request.mutable_sample()->set_points(points);
  const absl::StatusOr<client::DecodedSample> sample = server.resample(request);
  if (!sample.ok()) return sample.status();
  std::cout << sample->points.size() << " points\n";
  return absl::OkStatus();
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const absl::Status status = take(argv[1], std::strtoull(argv[2], nullptr, 10));
  if (status.ok()) return 0;
  std::cerr << status << '\n';
  return 1;
}
