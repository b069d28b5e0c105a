// What S3 says, in its XML and its errors.
#pragma once

#include <absl/status/status.h>

#include <string>
#include <string_view>

#include "server/store/http_transfer.h"

namespace curvecast::server {

/// The text of the first element of this name, which has no others in it; empty where there is none.
std::string xml_text(std::string_view xml, const std::string& element);
std::string xml_escaped(const std::string& text);

/// Of a response that is no success, or says in its body that it is none, to a request about `what`, such as "s3://BUCKET/NAME":
/// the error names that, the HTTP status and S3's code.
///   NotFound           there is no such object. A response to HEAD has no code, and may as well mean the bucket
///   ResourceExhausted  the store is full, or the object too large
///   Unavailable        may pass by itself
///   Aborted            there is no such multipart upload any more
///   PermissionDenied   all else: keys, rights, bucket, region
absl::Status s3_error(const std::string& method, const std::string& what, const HttpResponse& response);

/// Unavailable where a response of success lacks what every response of S3's about an object has: it is somebody else's, such as
/// a proxy's page.
absl::Status check_is_s3(const std::string& what, const HttpResponse& response);

}  // namespace curvecast::server
