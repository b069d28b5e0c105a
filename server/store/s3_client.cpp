#include "server/store/s3_client.h"

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <random>
#include <utility>

#include "core/base/random.h"
#include "server/base/hash.h"
#include "server/store/s3_error.h"

namespace curvecast::server {
namespace {

HttpOptions with_certificates(HttpOptions options, const S3Endpoint& endpoint) {
  options.ca_bundle = endpoint.ca_bundle;
  return options;
}

std::string encoded_path(const std::string& key) {
  return absl::StrJoin(absl::StrSplit(key, '/'), "/",
                       [](std::string* out, absl::string_view part) { *out += percent_encoded(std::string(part)); });
}

}  // namespace

S3Retry::S3Retry(const S3Options& options, const Deadline& deadline)
    : options_(options), deadline_(deadline), seed_(std::random_device()()), wait_(options.first_wait) {}

absl::Status S3Retry::after(const absl::Status& failure) {
  if (!absl::IsUnavailable(failure) || ++tries_ >= options_.tries) return failure;
  // Up to half less, which spreads the load of many servers that lost the same store.
  const double jitter = 0.5 + 0.5 * random_unit(seed_, waits_++);
  const absl::Status slept = deadline_.sleep(std::chrono::duration_cast<std::chrono::milliseconds>(wait_ * jitter));
  wait_ = std::min(wait_ * 2, options_.longest_wait);
  // Where time is up, what failed says more.
  return absl::IsUnavailable(slept) ? failure : slept;
}

void S3Retry::reset() {
  tries_ = 0;
  wait_ = options_.first_wait;
}

S3Client::S3Client(std::string bucket, S3Endpoint endpoint, std::unique_ptr<S3KeySource> keys, S3Options options)
    : bucket_(std::move(bucket)),
      endpoint_(std::move(endpoint)),
      options_(std::move(options)),
      keys_(std::move(keys)),
      transfer_(with_certificates(options_.http, endpoint_)) {}

std::string S3Client::name_of(const std::string& key) const { return absl::StrCat("s3://", bucket_, "/", key); }

absl::StatusOr<HttpResponse> S3Client::send_once(const S3Request& request, const Deadline& deadline) {
  const S3Keys keys = keys_->keys();
  absl::StatusOr<HttpResponse> response = send_with(keys, request, deadline);
  if (!absl::IsPermissionDenied(response.status())) return response;
  const std::optional<S3Keys> others = keys_->keys_instead_of(keys);
  return others ? send_with(*others, request, deadline) : response;
}

absl::StatusOr<HttpResponse> S3Client::send(const S3Request& request, const Deadline& deadline) {
  for (S3Retry retry(options_, deadline);;) {
    absl::StatusOr<HttpResponse> response = send_once(request, deadline);
    if (response.ok()) return response;
    if (absl::Status end = retry.after(response.status()); !end.ok()) return end;
  }
}

absl::StatusOr<HttpResponse> S3Client::send_with(const S3Keys& keys, const S3Request& request, const Deadline& deadline) {
  const HttpSignature signature{.access_key = keys.access_key, .secret = keys.secret, .region = endpoint_.region};
  HttpRequest http{
      .method = request.method,
      .url = absl::StrCat(endpoint_.url, "/", encoded_path(request.key), request.query.empty() ? "" : "?", request.query),
      .headers = request.headers,
      .signature = &signature,
      .body = request.body,
      .file = request.file,
      .offset = request.offset,
      .size = request.size};
  http.headers.push_back(absl::StrCat("x-amz-content-sha256: ",
                                      request.sha256.empty() ? absl::BytesToHexString(sha256(request.body)) : request.sha256));
  if (!keys.session_token.empty()) http.headers.push_back(absl::StrCat("x-amz-security-token: ", keys.session_token));
  absl::StatusOr<HttpResponse> response =
      transfer_.run(http, {.take = request.take, .check = [&deadline] { return deadline.check(); }});
  const std::string name = name_of(request.key);
  if (!response.ok()) {
    return absl::Status(response.status().code(), absl::StrCat(name, ": ", request.method, ": ", response.status().message()));
  }
  if (response->status / 100 != 2) return s3_error(request.method, name, *response);
  return response;
}

}  // namespace curvecast::server
