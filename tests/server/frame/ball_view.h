// A ball as a server has it that has just read it, and a look at it.
#pragma once

#include <memory>

#include "curvecast/v1/curvecast.pb.h"
#include "tests/server/ball_session.h"

namespace curvecast::server {

/// A session of a ball with ranked candidates of its own; all are of one preprocessing.
inline std::shared_ptr<const Session> fresh_ball() {
  static const std::shared_ptr<const Session> made = make_session(500);
  auto session = std::make_shared<Session>();
  session->options = made->options;
  session->preprocessed = made->preprocessed;
  session->surface = made->surface;
  session->revisions->publish(made->curve());
  return session;
}

/// Asks for even points on the screen, of a camera at so many radii from the surface of the ball.
inline void look_at_ball(double distance, v1::SampleRequest& sample) {
  sample.add_density()->mutable_screen();
  sample.add_density()->mutable_frustum();
  v1::Camera& camera = *sample.add_cameras();
  camera.mutable_eye()->set_z(1 + distance);
  camera.mutable_target()->set_z(0);
  camera.mutable_up()->set_y(1);
  camera.set_vertical_fov_degrees(40);
  sample.mutable_viewport()->set_width(1000);
  sample.mutable_viewport()->set_height(1000);
}

}  // namespace curvecast::server
