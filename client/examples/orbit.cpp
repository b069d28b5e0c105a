// SPDX-License-Identifier: Apache-2.0
// A camera that goes round a mesh, with the points for each view as they come:  example_orbit localhost:50051 mesh.obj 50000 360
// Stop the server meanwhile and start it again (with --cache): the orbit goes on.
#include <cmath>
#include <cstdlib>
#include <future>
#include <iostream>
#include <string>
#include <utility>

#include <curvecast/client/client.h>
#include <curvecast/client/live_view.h>

namespace client = curvecast::client;
namespace v1 = curvecast::v1;

/// What the camera is to see from a place on the circle: `points` points, those in front, denser along the silhouette.
v1::SampleRequest sample_at(double angle, const v1::MeshInfo& mesh, std::uint64_t points) {
  const v1::Vec3 &low = mesh.box_min(), &high = mesh.box_max();
  const double reach = 1.5 * std::hypot(high.x() - low.x(), high.y() - low.y(), high.z() - low.z());
  v1::SampleRequest sample;
  v1::Vec3& target = *sample.add_cameras()->mutable_target();
  target.set_x((low.x() + high.x()) / 2);
  target.set_y((low.y() + high.y()) / 2);
  target.set_z((low.z() + high.z()) / 2);
  v1::Vec3& eye = *sample.mutable_cameras(0)->mutable_eye();
  eye.set_x(target.x() + reach * std::sin(angle));
  eye.set_y(target.y() + reach * 0.2);
  eye.set_z(target.z() + reach * std::cos(angle));
  sample.add_density()->mutable_view();
  sample.set_points(points);
  sample.set_sampler(v1::SAMPLER_PROGRESSIVE);  // points stay where they are from view to view, so that frames are small
  return sample;
}

absl::Status orbit(const std::string& address, const std::string& mesh_path, std::uint64_t points, std::uint64_t views) {
  client::Client server(client::make_connection(client::tcp_channel(address)));
  const absl::StatusOr<client::UploadedMesh> mesh = server.upload_with_companions(mesh_path);
  if (!mesh.ok()) return mesh.status();
  const absl::StatusOr<v1::Session> session = server.create_session(*mesh, {});
  if (!session.ok()) return session.status();
  const auto sample = [&](std::uint64_t view) {
    return sample_at(2 * M_PI * static_cast<double>(view) / static_cast<double>(views), session->report().mesh(), points);
  };

  // Callbacks come from a thread of the view's own, but one at a time, and not before the first look().
  std::promise<absl::Status> result;
  auto finish = [&result, is_over = false](const absl::Status& status) mutable {
    if (!std::exchange(is_over, true)) result.set_value(status);
  };
  const auto on_state = [&](client::LiveViewState state, const absl::Status& status) {
    if (state == client::LiveViewState::kWaiting) std::cerr << "trying again: " << status.message() << '\n';
    if (state == client::LiveViewState::kEnded) finish(status);
  };
  const auto on_frame = [&](client::LiveView& view, const client::Frame& frame) {
    if (!frame.error.ok()) return finish(frame.error);
    // Here a viewer draws frame.points: all that there are now, however few of them came with the frame.
    std::cout << "view " << frame.sequence << ": " << frame.points->size() << " points, " << (frame.is_delta ? "delta" : "key")
              << " of " << frame.encoded_bytes << " bytes, +" << frame.added << " -" << frame.removed << std::endl;
    if (frame.statistics.refining()) return;  // a better frame for this view follows by itself
    if (frame.sequence >= views) return finish(absl::OkStatus());
    view.look(sample(frame.sequence + 1));
  };
  client::LiveView view(server.connection(), session->session_id(),
                        {.on_frame = [&](const client::Frame& frame) { on_frame(view, frame); }, .on_state = on_state});
  view.look(sample(1));  // never waits: a viewer calls it whenever its camera has moved
  return result.get_future().get();
}

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "Usage: " << argv[0] << " ADDRESS MESH POINTS VIEWS\n";
    return 2;
  }
  const absl::Status status = orbit(argv[1], argv[2], std::strtoull(argv[3], nullptr, 10), std::strtoull(argv[4], nullptr, 10));
  if (status.ok()) return 0;
  std::cerr << argv[0] << ": " << status.message() << '\n';
  return 1;
}
