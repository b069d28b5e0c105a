#include "server/engine/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "tests/server/has_line.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Metrics, EveryFamilyHasHelpAndType) {
  Metrics metrics;
  const std::string text = metrics.text({});
  for (const char* name :
       {"curvecast_build_info", "curvecast_sessions", "curvecast_queue_depth", "process_resident_memory_bytes"}) {
    EXPECT_THAT(text, HasSubstr(std::string("# HELP ") + name + " "));
    EXPECT_TRUE(has_line(text, std::string("# TYPE ") + name + " gauge"));
  }
  EXPECT_TRUE(has_line(text, "# TYPE curvecast_frames_total counter"));
  EXPECT_TRUE(has_line(text, "# TYPE curvecast_stage_seconds histogram"));
  EXPECT_TRUE(has_line(text, "curvecast_frames_total{kind=\"delta\"} 0"));
  EXPECT_THAT(text, Not(HasSubstr("process_resident_memory_bytes 0\n")));
}

TEST(Metrics, RequestsByMethodAndCode) {
  Metrics metrics;
  metrics.request("GetMesh", 0, 0.002);
  metrics.request("GetMesh", 0, 0.2);
  metrics.request("GetMesh", 5, 0.002);
  const std::string text = metrics.text({});
  EXPECT_TRUE(has_line(text, "curvecast_requests_total{code=\"OK\",method=\"GetMesh\"} 2"));
  EXPECT_TRUE(has_line(text, "curvecast_requests_total{code=\"NOT_FOUND\",method=\"GetMesh\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_request_seconds_count{method=\"GetMesh\"} 3"));
  EXPECT_TRUE(has_line(text, "curvecast_request_seconds_bucket{method=\"GetMesh\",le=\"0.0025\"} 2"));
  EXPECT_TRUE(has_line(text, "curvecast_request_seconds_bucket{method=\"GetMesh\",le=\"+Inf\"} 3"));
}

TEST(Metrics, FramesByKind) {
  Metrics metrics;
  v1::PointFrame key, delta, error;
  key.set_kind(v1::FRAME_KIND_KEY);
  key.add_points()->set_count(40);
  key.add_points()->set_count(60);
  key.mutable_statistics()->set_density_seconds(0.002);
  delta.set_kind(v1::FRAME_KIND_DELTA);
  delta.add_points()->set_count(7);
  error.mutable_error()->set_code(3);
  metrics.frame(key);
  metrics.frame(key);
  metrics.frame(delta);
  metrics.frame(error);
  const std::string text = metrics.text({});
  EXPECT_TRUE(has_line(text, "curvecast_frames_total{kind=\"key\"} 2"));
  EXPECT_TRUE(has_line(text, "curvecast_frames_total{kind=\"delta\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_frames_total{kind=\"error\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_frame_points_total{kind=\"key\"} 200"));
  EXPECT_TRUE(has_line(text, "curvecast_frame_points_total{kind=\"delta\"} 7"));
  EXPECT_TRUE(has_line(text, "curvecast_frame_bytes_total{kind=\"key\"} " + std::to_string(2 * key.ByteSizeLong())));
  EXPECT_TRUE(has_line(text, "curvecast_stage_seconds_count{stage=\"density\"} 3"));  // an error has no stages
  EXPECT_TRUE(has_line(text, "curvecast_stage_seconds_bucket{stage=\"density\",le=\"0.001\"} 1"));
}

TEST(Metrics, LevelsAreThoseOfTheMoment) {
  Metrics metrics;
  metrics.text({.waiting_views = 3, .sessions = 2, .session_bytes = 1'000'000});
  const std::string text =
      metrics.text({.waiting_views = 1, .waiting_preprocessing = 4, .meshes = 5, .cache_bytes = 123'456'789'012});
  EXPECT_TRUE(has_line(text, "curvecast_queue_depth{queue=\"views\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_queue_depth{queue=\"preprocessing\"} 4"));
  EXPECT_TRUE(has_line(text, "curvecast_queue_depth{queue=\"calls\"} 0"));
  EXPECT_TRUE(has_line(text, "curvecast_sessions 0"));
  EXPECT_TRUE(has_line(text, "curvecast_meshes 5"));
  EXPECT_TRUE(has_line(text, "curvecast_cache_bytes 123456789012"));
}

TEST(Metrics, ViewsTakeTheirWaitAndTheirWork) {
  Metrics metrics;
  metrics.view_job(0.002, 0.004);
  metrics.view_job(0, 0.02);
  const std::string text = metrics.text({.threads = 4});
  EXPECT_TRUE(has_line(text, "curvecast_view_wait_seconds_bucket{le=\"0.0025\"} 2"));
  EXPECT_TRUE(has_line(text, "curvecast_view_seconds_bucket{le=\"0.005\"} 0"));
  EXPECT_TRUE(has_line(text, "curvecast_view_seconds_bucket{le=\"0.01\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_view_seconds_count 2"));
  EXPECT_TRUE(has_line(text, "curvecast_view_worker_busy_seconds_total 0.024"));
  EXPECT_TRUE(has_line(text, "curvecast_threads 4"));
}

TEST(Metrics, TellsOfMemoryLimitsAndTheCache) {
  Metrics metrics;
  metrics.stalled(2);
  metrics.stalled(1);
  metrics.unauthenticated();
  metrics.preprocessing(8, 3);
  metrics.store_call("put", "ok", 0.2);
  const Gauges earlier = {.shared_frames = 2, .refused = {{"memory", 1}}, .cache_operations = {{{"save", "ok"}, 4}}};
  metrics.text(earlier);
  const std::string text = metrics.text({.shared_frames = 5,
                                         .connections = 6,
                                         .ended_connections = 7,
                                         .refused_connections = 8,
                                         .overdue_views = 1,
                                         .overdue_preprocessing = 2,
                                         .queued_bytes = 9,
                                         .memory_bytes = 1000,
                                         .held_bytes = 200,
                                         .reserved_bytes = 30,
                                         .refused = {{"memory", 3}, {"streams", 1}},
                                         .unsaved_sessions = 4,
                                         .unstored = 5,
                                         .cache_operations = {{{"save", "ok"}, 6}, {{"load", "error"}, 1}}});
  for (const char* line : {"curvecast_stalled_calls_total 3",
                           "curvecast_unauthenticated_total 1",
                           "curvecast_preprocess_seconds_count{code=\"RESOURCE_EXHAUSTED\"} 1",
                           "curvecast_frames_shared_total 5",
                           "curvecast_connections 6",
                           "curvecast_connections_ended_total 7",
                           "curvecast_connections_refused_total 8",
                           "curvecast_jobs_overdue{queue=\"views\"} 1",
                           "curvecast_jobs_overdue{queue=\"calls\"} 0",
                           "curvecast_jobs_overdue{queue=\"preprocessing\"} 2",
                           "curvecast_queued_bytes 9",
                           "curvecast_memory_budget_bytes 1000",
                           "curvecast_memory_held_bytes 200",
                           "curvecast_memory_reserved_bytes 30",
                           "curvecast_refused_total{limit=\"memory\"} 3",
                           "curvecast_refused_total{limit=\"streams\"} 1",
                           "curvecast_unsaved_sessions 4",
                           "curvecast_unstored 5",
                           "curvecast_store_operations_total{operation=\"put\",result=\"ok\"} 1",
                           "curvecast_store_operations_total{operation=\"put\",result=\"error\"} 0",
                           "curvecast_store_seconds_count{operation=\"put\"} 1",
                           "curvecast_cache_operations_total{operation=\"save\",result=\"ok\"} 6",
                           "curvecast_cache_operations_total{operation=\"load\",result=\"error\"} 1"}) {
    EXPECT_TRUE(has_line(text, line));
  }
}

TEST(Metrics, LosesNothingBetweenThreads) {
  constexpr int kThreads = 4, kEach = 10'000;
  Metrics metrics;
  std::vector<std::jthread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < kEach; ++k) {
        metrics.view_received();
        metrics.stages({});
        if (k % 1000 == 0) metrics.text({});
      }
    });
  }
  threads.clear();
  const std::string text = metrics.text({});
  EXPECT_TRUE(has_line(text, "curvecast_views_received_total 40000"));
  EXPECT_TRUE(has_line(text, "curvecast_stage_seconds_count{stage=\"encode\"} 40000"));
}

}  // namespace
}  // namespace curvecast::server
