#include "server/base/grpc_status.h"

#include <gtest/gtest.h>

#include "curvecast/v1/status.pb.h"
#include "server/convert/field_validator.h"

namespace curvecast::server {
namespace {

v1::Status details_of(const absl::Status& status) {
  v1::Status rich;
  EXPECT_TRUE(rich.ParseFromString(to_grpc(status).error_details()));
  return rich;
}

TEST(GrpcStatus, KeepsCodeAndMessage) {
  EXPECT_TRUE(to_grpc(absl::OkStatus()).ok());
  const grpc::Status status = to_grpc(absl::NotFoundError("no such thing"));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(status.error_message(), "no such thing");
  EXPECT_TRUE(status.error_details().empty());
  EXPECT_LT(to_grpc(absl::InternalError(std::string(1 << 20, 'x'))).error_message().size(), 8192u);
}

TEST(GrpcStatus, SaysWhenToTryAgain) {
  const v1::Status rich = details_of(absl::ResourceExhaustedError("full"));
  EXPECT_EQ(rich.code(), static_cast<int>(grpc::StatusCode::RESOURCE_EXHAUSTED));
  ASSERT_EQ(rich.details_size(), 1);
  EXPECT_EQ(rich.details(0).type_url(), "type.googleapis.com/google.rpc.RetryInfo");
  v1::RetryInfo retry;
  ASSERT_TRUE(retry.ParseFromString(rich.details(0).value()));
  EXPECT_GE(retry.retry_delay().seconds(), 1);
}

TEST(GrpcStatus, NamesTheField) {
  FieldValidator check;
  check.in_range("sample.points", 0, 1, 10);
  check.fail("sample.seed", "is too late: the first error counts");
  const v1::Status rich = details_of(check.status());
  ASSERT_EQ(rich.details_size(), 1);
  EXPECT_EQ(rich.details(0).type_url(), "type.googleapis.com/google.rpc.BadRequest");
  v1::BadRequest bad;
  ASSERT_TRUE(bad.ParseFromString(rich.details(0).value()));
  ASSERT_EQ(bad.field_violations_size(), 1);
  EXPECT_EQ(bad.field_violations(0).field(), "sample.points");
  EXPECT_EQ(bad.field_violations(0).description(), "is 0; it must be from 1 to 10");
}

}  // namespace
}  // namespace curvecast::server
