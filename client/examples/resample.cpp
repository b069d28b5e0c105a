// SPDX-License-Identifier: Apache-2.0
// A mesh to evenly spread points, in a PLY file:  example_resample localhost:50051 mesh.obj 50000 points.ply
#include <cstdlib>
#include <iostream>
#include <string>

#include <curvecast/client/client.h>
#include <curvecast/client/point_file.h>

namespace client = curvecast::client;
namespace v1 = curvecast::v1;

// Nothing here throws: what may fail says so with an absl::Status, which the caller hands on or shows.
absl::Status resample(const std::string& address, const std::string& mesh_path, std::uint64_t points, const std::string& out) {
  // Connects with the first call. Calls are repeated when the server is away for a moment.
  client::Client server(client::make_connection(client::tcp_channel(address)));

  // Sends the file, and textures that it names; a mesh that the server holds already is not sent again.
  const absl::StatusOr<client::UploadedMesh> mesh = server.upload_with_companions(mesh_path);
  if (!mesh.ok()) return mesh.status();

  // The long work, done once: everybody who asks for the same mesh and options shares the session.
  v1::SessionOptions options;
  options.set_max_points(points);
  const absl::StatusOr<v1::Session> session = server.create_session(*mesh, options, [](std::string_view stage, double fraction) {
    std::cerr << '\r' << stage << ' ' << static_cast<int>(100 * fraction) << " %   ";
  });
  std::cerr << '\n';
  if (!session.ok()) return session.status();

  // The short work, as often as you like: a number of points, and where they are dense (here: where the surface is curved).
  v1::ResampleRequest request;
  request.set_session_id(session->session_id());
  request.mutable_sample()->set_points(points);
  request.mutable_sample()->add_density()->mutable_curvature()->set_floor(0.2);
  const absl::StatusOr<client::DecodedSample> sample = server.resample(request);
  if (!sample.ok()) return sample.status();

  std::cout << sample->points.size() << " points in " << sample->bytes << " bytes, to " << out << '\n';
  return client::write_point_file(out, sample->points);
}

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "Usage: " << argv[0] << " ADDRESS MESH POINTS OUT.ply\n";
    return 2;
  }
  const absl::Status status = resample(argv[1], argv[2], std::strtoull(argv[3], nullptr, 10), argv[4]);
  if (status.ok()) return 0;
  std::cerr << argv[0] << ": " << status.message() << '\n';
  return 1;
}
