#include "server/store/s3_error.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include <algorithm>
#include <array>

#include "server/base/log.h"

namespace curvecast::server {
namespace {

using absl::StatusCode;

struct KnownCode {
  std::string_view code;
  StatusCode status;
  const char* hint = "";
};

constexpr std::array kKnownCodes = {
    KnownCode{"NoSuchKey", StatusCode::kNotFound},
    KnownCode{"NoSuchUpload", StatusCode::kAborted},
    KnownCode{"NoSuchBucket", StatusCode::kPermissionDenied, ": there is no such bucket"},
    KnownCode{"RequestTimeTooSkewed", StatusCode::kPermissionDenied, ": the clock of this machine, or the store's, is wrong"},
    // What S3 says with 400, and is over at the next try all the same.
    KnownCode{"RequestTimeout", StatusCode::kUnavailable},
    KnownCode{"IncompleteBody", StatusCode::kUnavailable},
    KnownCode{"BadDigest", StatusCode::kUnavailable, ": other bytes arrived than were sent"},
    KnownCode{"XAmzContentSHA256Mismatch", StatusCode::kUnavailable, ": other bytes arrived than were sent"},
    KnownCode{"OperationAborted", StatusCode::kUnavailable},
    KnownCode{"QuotaExceeded", StatusCode::kResourceExhausted},
    KnownCode{"EntityTooLarge", StatusCode::kResourceExhausted},
    // MinIO's.
    KnownCode{"XMinioStorageFull", StatusCode::kResourceExhausted},
    KnownCode{"XMinioAdminBucketQuotaExceeded", StatusCode::kResourceExhausted},
};

StatusCode of_http_status(int status) {
  constexpr int kRequestTimeout = 408, kConflict = 409, kTooLarge = 413, kTooMany = 429, kTemporaryRedirect = 307, kFull = 507;
  if (status == kFull || status == kTooLarge) return StatusCode::kResourceExhausted;
  const bool passes = status >= 500 || status == kRequestTimeout || status == kConflict || status == kTooMany ||
                      status == kTemporaryRedirect ||  // of a bucket that is minutes old
                      status / 100 == 2;               // it went wrong after S3 had said that
  return passes ? StatusCode::kUnavailable : StatusCode::kPermissionDenied;
}

}  // namespace

std::string xml_text(std::string_view xml, const std::string& element) {
  const std::string opening = absl::StrCat("<", element, ">");
  const std::size_t begin = xml.find(opening);
  if (begin == std::string_view::npos) return "";
  xml.remove_prefix(begin + opening.size());
  const std::size_t end = xml.find('<');
  if (end == std::string_view::npos) return "";
  return absl::StrReplaceAll(
      absl::string_view(xml.data(), end),
      {{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#34;", "\""}, {"&apos;", "'"}, {"&#39;", "'"}, {"&amp;", "&"}});
}

std::string xml_escaped(const std::string& text) {
  return absl::StrReplaceAll(text, {{"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"&", "&amp;"}});
}

absl::Status s3_error(const std::string& method, const std::string& what, const HttpResponse& response) {
  const std::string code = xml_text(response.body, "Code");
  const std::string message =
      absl::StrCat(what, ": ", method, ": HTTP ", response.status, code.empty() ? "" : " ", printable(code));
  const auto known = std::find_if(kKnownCodes.begin(), kKnownCodes.end(), [&](const KnownCode& k) { return k.code == code; });
  if (known != kKnownCodes.end()) return {known->status, absl::StrCat(message, known->hint)};
  if (method == "HEAD" && response.status == 404) return absl::NotFoundError(message);
  const StatusCode status = of_http_status(response.status);
  const std::string region = response.header("x-amz-bucket-region");
  if (status == StatusCode::kPermissionDenied && response.status != 403 && !region.empty()) {
    return {status, absl::StrCat(message, ": the bucket is in the region ", printable(region), " (AWS_REGION)")};
  }
  if (response.status == 404) return {status, absl::StrCat(message, ": what answers there is no S3")};
  return {status, message};
}

absl::Status check_is_s3(const std::string& what, const HttpResponse& response) {
  if (!response.header("etag").empty()) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat(what, ": HTTP ", response.status, " without an ETag: what answers there is no S3"));
}

}  // namespace curvecast::server
