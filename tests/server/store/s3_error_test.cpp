#include "server/store/s3_error.h"

#include <gmock/gmock.h>

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

HttpResponse response(int status, const std::string& body = "") { return {.status = status, .headers = {}, .body = body}; }

std::string coded(const std::string& code) {
  return "<?xml version=\"1.0\"?>\n<Error><Code>" + code +
         "</Code><Message>m</Message><AWSAccessKeyId>AK</AWSAccessKeyId></Error>";
}

absl::StatusCode code_of(int status, const std::string& code) {
  return s3_error("GET", "s3://b/k", response(status, code.empty() ? "" : coded(code))).code();
}

TEST(S3Error, TellsWhatMayPassFromWhatMayNot) {
  using absl::StatusCode;
  EXPECT_EQ(code_of(404, "NoSuchKey"), StatusCode::kNotFound);
  EXPECT_EQ(code_of(404, "NoSuchBucket"), StatusCode::kPermissionDenied);
  EXPECT_EQ(code_of(404, ""), StatusCode::kPermissionDenied) << "not of S3";
  EXPECT_EQ(code_of(404, "NoSuchUpload"), StatusCode::kAborted);
  for (const char* code : {"AccessDenied", "InvalidAccessKeyId", "SignatureDoesNotMatch", "RequestTimeTooSkewed", ""}) {
    EXPECT_EQ(code_of(403, code), StatusCode::kPermissionDenied) << code;
  }
  EXPECT_EQ(code_of(400, "ExpiredToken"), StatusCode::kPermissionDenied);
  EXPECT_EQ(code_of(401, ""), StatusCode::kPermissionDenied);
  EXPECT_EQ(code_of(301, "PermanentRedirect"), StatusCode::kPermissionDenied);
  EXPECT_EQ(code_of(400, "RequestTimeout"), StatusCode::kUnavailable);
  EXPECT_EQ(code_of(400, "BadDigest"), StatusCode::kUnavailable);
  for (const int status : {307, 408, 409, 429, 500, 502, 503, 504})
    EXPECT_EQ(code_of(status, ""), StatusCode::kUnavailable) << status;
  EXPECT_EQ(code_of(503, "SlowDown"), StatusCode::kUnavailable);
  EXPECT_EQ(code_of(200, "InternalError"), StatusCode::kUnavailable) << "of an upload that is completed";
  EXPECT_EQ(code_of(507, "XMinioStorageFull"), StatusCode::kResourceExhausted);
  EXPECT_EQ(code_of(507, ""), StatusCode::kResourceExhausted);
  EXPECT_EQ(code_of(403, "QuotaExceeded"), StatusCode::kResourceExhausted);
  EXPECT_EQ(s3_error("HEAD", "s3://b/k", response(404)).code(), StatusCode::kNotFound) << "it never has a body";
}

TEST(S3Error, NamesWhatItIsAboutAndNothingElse) {
  const absl::Status status = s3_error("PUT", "s3://b/k", response(403, coded("AccessDenied")));
  EXPECT_EQ(status.message(), "s3://b/k: PUT: HTTP 403 AccessDenied");
  const absl::Status hostile = s3_error("PUT", "s3://b/k", response(403, coded("a\nb" + std::string(1000, 'x'))));
  EXPECT_THAT(hostile.message(), Not(HasSubstr("\n")));
  EXPECT_LT(hostile.message().size(), 200u);
}

TEST(S3Error, SaysWhatToDo) {
  EXPECT_THAT(s3_error("PUT", "s3://b/k", response(404, coded("NoSuchBucket"))).message(), HasSubstr("no such bucket"));
  EXPECT_THAT(s3_error("PUT", "s3://b/k", response(403, coded("RequestTimeTooSkewed"))).message(), HasSubstr("clock"));
  HttpResponse elsewhere = response(301, coded("PermanentRedirect"));
  elsewhere.headers["x-amz-bucket-region"] = "eu-west-1";
  EXPECT_THAT(s3_error("PUT", "s3://b/k", elsewhere).message(), HasSubstr("eu-west-1 (AWS_REGION)"));
}

TEST(CheckIsS3, WantsAnETag) {
  HttpResponse page = response(200, "<html>please log in</html>");
  EXPECT_TRUE(absl::IsUnavailable(check_is_s3("s3://b/k", page)));
  page.headers["etag"] = "\"x\"";
  EXPECT_EQ(check_is_s3("s3://b/k", page), absl::OkStatus());
}

TEST(XmlText, IsThatOfTheFirstElement) {
  EXPECT_EQ(xml_text("<a><B>x &lt;&amp;amp;&gt; &quot;y&quot; &#34;&apos;&#39;</B><B>z</B></a>", "B"), "x <&amp;> \"y\" \"''");
  EXPECT_EQ(xml_text("<B></B>", "B"), "");
  EXPECT_EQ(xml_text("<B>x", "B"), "");
  EXPECT_EQ(xml_text("", "B"), "");
  EXPECT_EQ(xml_text("no xml at all", "B"), "");
}

TEST(XmlEscaped, IsReadBack) {
  for (const char* text : {"\"abc\"", "<&>", "&amp;", "plain"}) {
    EXPECT_EQ(xml_text("<B>" + xml_escaped(text) + "</B>", "B"), text);
  }
}

}  // namespace
}  // namespace curvecast::server
