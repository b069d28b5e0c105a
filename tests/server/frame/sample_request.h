// A request with everything in it, and ways to spoil it.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "server/convert/convert.h"

namespace curvecast::server {

/// With every kind of term and a camera, all valid.
inline v1::SampleRequest good_request() {
  v1::SampleRequest request;
  request.set_points(1000);
  request.set_seed(7);
  request.add_density()->mutable_uniform();
  request.add_density()->mutable_curvature();
  request.add_density()->mutable_view();
  request.add_cameras()->mutable_eye()->set_z(3);
  request.add_density()->mutable_attribute()->set_name("heat");
  v1::BrushStroke& brush = *request.add_density()->mutable_brush()->add_strokes();
  brush.mutable_centre()->set_x(1);
  brush.set_radius(2);
  brush.set_factor(3);
  request.add_density()->mutable_distance();
  request.add_density()->mutable_frustum();
  request.add_density()->mutable_screen();
  request.add_density()->mutable_expression()->set_text("1 + heat");
  request.mutable_viewport()->set_width(640);
  request.mutable_viewport()->set_height(480);
  return request;
}

struct Hostile {
  const char* message;  // what the error must say
  std::function<void(v1::SampleRequest&)> spoil;
};

inline void expect_refusals(const std::vector<Hostile>& cases) {
  for (const Hostile& hostile : cases) {
    v1::SampleRequest request = good_request();
    hostile.spoil(request);
    const auto sample = to_point_set_request(request);
    EXPECT_EQ(sample.status().code(), absl::StatusCode::kInvalidArgument) << hostile.message;
    EXPECT_THAT(sample.status().message(), ::testing::HasSubstr(hostile.message));
  }
}

}  // namespace curvecast::server
