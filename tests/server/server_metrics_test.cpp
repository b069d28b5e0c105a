// What /metrics tells of a server at work.
#include <gtest/gtest.h>

#include "server_fixture.h"
#include "tests/server/eventually.h"
#include "tests/server/has_line.h"
#include "tests/server/opened_stream.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

class ServerMetrics : public ServerFixture {
 protected:
  void SetUp() override { start({.max_streams = 1, .memory_bytes = kMemory, .cache = folder_.path(), .admin = "127.0.0.1:0"}); }

  double refused(const std::string& limit) const { return metric("curvecast_refused_total{limit=\"" + limit + "\"}"); }
  double cached(const std::string& operation) const {
    return metric("curvecast_cache_operations_total{operation=\"" + operation + "\",result=\"ok\"}");
  }

  static constexpr std::uint64_t kMemory = std::uint64_t{512} << 20;
  const testing::TemporaryFolder folder_;
};

TEST_F(ServerMetrics, AreAllThereFromTheBeginning) {
  const std::string text = metrics();
  for (const char* line :
       {"curvecast_stalled_calls_total 0", "curvecast_unauthenticated_total 0", "curvecast_frames_shared_total 0",
        "curvecast_connections_ended_total 0", "curvecast_connections_refused_total 0", "curvecast_queued_bytes 0",
        "curvecast_memory_held_bytes 0", "curvecast_memory_reserved_bytes 0", "curvecast_unsaved_sessions 0",
        "curvecast_cache_bytes 0", "curvecast_session_bytes 0"}) {
    EXPECT_TRUE(has_line(text, line));
  }
  EXPECT_GE(value_of(text, "curvecast_threads"), 1);
  for (const std::string queue : {"views", "calls", "chunks", "preprocessing"}) {
    EXPECT_TRUE(has_line(text, "curvecast_queue_depth{queue=\"" + queue + "\"} 0"));
    EXPECT_TRUE(has_line(text, "curvecast_jobs_overdue{queue=\"" + queue + "\"} 0"));
  }
  for (const std::string limit :
       {"streams", "uploads", "waiting_views", "waiting_calls", "waiting_preprocessing", "queued_bytes", "memory"}) {
    EXPECT_TRUE(has_line(text, "curvecast_refused_total{limit=\"" + limit + "\"} 0"));
  }
  for (const std::string operation : {"load", "save", "remove"}) {
    for (const std::string result : {"ok", "error"}) {
      EXPECT_TRUE(
          has_line(text, "curvecast_cache_operations_total{operation=\"" + operation + "\",result=\"" + result + "\"} 0"));
    }
  }
  EXPECT_GE(value_of(text, "curvecast_memory_budget_bytes"), static_cast<double>(kMemory));
}

TEST_F(ServerMetrics, CountWhatSessionsTakeAndWhereTheyAre) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(4)), 2'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  EXPECT_TRUE(eventually([&] { return cached("save") == 1; }));
  EXPECT_TRUE(eventually([&] { return metric("curvecast_memory_reserved_bytes") == 0; }));
  const std::string text = metrics();
  EXPECT_GT(value_of(text, "curvecast_session_bytes"), 0);
  EXPECT_GE(value_of(text, "curvecast_memory_held_bytes"), value_of(text, "curvecast_session_bytes"));
  EXPECT_LT(value_of(text, "curvecast_memory_held_bytes"), value_of(text, "curvecast_memory_budget_bytes"));
  EXPECT_TRUE(has_line(text, "curvecast_sessions 1"));
  EXPECT_TRUE(has_line(text, "curvecast_unsaved_sessions 0"));
  EXPECT_TRUE(has_line(text, "curvecast_preprocess_seconds_count{code=\"OK\"} 1"));
  grpc::ClientContext context;
  v1::CloseSessionRequest close;
  close.set_session_id(created.session.session_id());
  v1::CloseSessionResponse closed;
  ASSERT_TRUE(stub->CloseSession(&context, close, &closed).ok());
  EXPECT_EQ(cached("remove"), 1);
  EXPECT_EQ(metric("curvecast_session_bytes"), 0);
}

TEST_F(ServerMetrics, CountWhatIsRefusedByItsLimit) {
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(3));
  const Created created = create(*stub, mesh, 1'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  OpenedStream stream(*stub, created.session.session_id());
  EXPECT_TRUE(stream.answer().ok());
  EXPECT_EQ(refused("streams"), 0);
  OpenedStream second(*stub, created.session.session_id());
  EXPECT_EQ(second.answer().error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused("streams"), 1);
  EXPECT_EQ(metric("curvecast_open_streams"), 1);
  stream.stream->WritesDone();
  EXPECT_TRUE(stream.stream->Finish().ok());
}

}  // namespace
}  // namespace curvecast::server
