#include "client/lib/retry.h"

#include <gtest/gtest.h>

#include <limits>

#include "curvecast/v1/status.pb.h"

namespace curvecast::client {
namespace {

using std::chrono::milliseconds;

TEST(Retry, KnowsWhatWasLost) {
  EXPECT_TRUE(is_lost(absl::UnavailableError("")));
  EXPECT_TRUE(is_lost(absl::CancelledError("")));
  EXPECT_TRUE(is_lost(absl::InternalError("Received RST_STREAM with error code 2")));
  EXPECT_TRUE(is_lost(absl::UnknownError("Stream removed")));
  EXPECT_TRUE(is_lost(absl::UnknownError("No status received")));
  EXPECT_FALSE(is_lost(absl::UnknownError("something else")));
  EXPECT_FALSE(is_lost(absl::InternalError("the server is broken")));
  EXPECT_FALSE(is_lost(absl::NotFoundError("")));
  EXPECT_FALSE(is_lost(absl::OkStatus()));
}

TEST(Retry, AStatusSaysWhenToTryAgain) {
  absl::Status status = absl::ResourceExhaustedError("full");
  EXPECT_FALSE(retry_after(status).has_value());
  set_retry_after(status, milliseconds(1250));
  EXPECT_EQ(retry_after(status), milliseconds(1250));
  set_retry_after(status, std::chrono::duration<double>(std::numeric_limits<double>::infinity()));
  EXPECT_EQ(retry_after(status), std::chrono::hours(1));
  set_retry_after(status, milliseconds(-5));
  EXPECT_EQ(retry_after(status), milliseconds(0));
}

TEST(Retry, ReadsHostilePayloads) {
  absl::Status status = absl::ResourceExhaustedError("full");
  status.SetPayload(kRetryInfo, absl::Cord("\xff\xff\xff"));
  EXPECT_FALSE(retry_after(status).has_value());
  status.SetPayload(kRetryInfo, absl::Cord(""));
  EXPECT_FALSE(retry_after(status).has_value());
  v1::RetryInfo info;
  info.mutable_retry_delay()->set_seconds(std::numeric_limits<std::int64_t>::max());
  info.mutable_retry_delay()->set_nanos(std::numeric_limits<std::int32_t>::max());
  status.SetPayload(kRetryInfo, absl::Cord(info.SerializeAsString()));
  EXPECT_EQ(retry_after(status), std::chrono::hours(1));
  info.mutable_retry_delay()->set_seconds(std::numeric_limits<std::int64_t>::min());
  info.mutable_retry_delay()->set_nanos(std::numeric_limits<std::int32_t>::min());
  status.SetPayload(kRetryInfo, absl::Cord(info.SerializeAsString()));
  EXPECT_EQ(retry_after(status), milliseconds(0));
}

TEST(Retry, PausesDoubleUpToTheLongest) {
  Backoff backoff(milliseconds(100), milliseconds(5'000));
  for (int round = 0; round < 2; ++round) {
    for (const int longest : {100, 200, 400, 800, 1600, 3200, 5000, 5000}) {
      const milliseconds pause = backoff.next();
      EXPECT_GE(pause, milliseconds(longest / 2));
      EXPECT_LE(pause, milliseconds(longest));
    }
    backoff.reset();
  }
}

TEST(Retry, StopEndsASleep) {
  std::stop_source source;
  EXPECT_TRUE(sleep_for(milliseconds(0), source.get_token()));
  source.request_stop();
  EXPECT_FALSE(sleep_for(std::chrono::hours(1), source.get_token()));
}

}  // namespace
}  // namespace curvecast::client
