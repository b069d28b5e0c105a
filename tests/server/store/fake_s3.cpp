#include "tests/server/store/fake_s3.h"

#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

#include <chrono>

#include "core/base/random.h"
#include "server/base/hash.h"

namespace curvecast::server {
namespace {

constexpr char kBucket[] = "/bucket/";
constexpr char kSha256[] = "x-amz-meta-sha256";

std::string sha256_of(const std::string& bytes) {
  Hasher hasher;
  hasher.update(bytes);
  return hasher.sha256();
}

std::string etag_of(const std::string& bytes) { return absl::StrCat("\"", sha256_of(bytes).substr(0, 32), "\""); }

std::string decoded(absl::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    int byte = text[i];
    if (text[i] == '%' && absl::SimpleHexAtoi(text.substr(i + 1, 2), &byte)) i += 2;
    out += static_cast<char>(byte);
  }
  return out;
}

/// Of a query.
std::string parameter(const std::string& query, const std::string& name) {
  for (const absl::string_view word : absl::StrSplit(query, '&')) {
    const std::pair<std::string, std::string> pair = absl::StrSplit(word, absl::MaxSplits('=', 1));
    if (pair.first == name) return decoded(pair.second);
  }
  return "";
}

}  // namespace

std::string some_bytes(std::size_t size, std::uint64_t seed) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(mix_bits(random_start(seed) + i));
  return bytes;
}

Environment FakeS3::environment() const {
  return [url = url()](const std::string& name) -> std::string {
    static const std::map<std::string, std::string> settings = {{"AWS_ACCESS_KEY_ID", "AKEXAMPLE"},
                                                                {"AWS_SECRET_ACCESS_KEY", "hush-hush"}};
    if (name == "AWS_ENDPOINT_URL") return url;
    const auto it = settings.find(name);
    return it == settings.end() ? "" : it->second;
  };
}

S3Endpoint FakeS3::endpoint() const { return {.url = absl::StrCat(url(), "/bucket"), .region = "us-east-1", .ca_bundle = ""}; }

S3Options FakeS3::options() {
  return {.http = {.ca_bundle = "", .connect_timeout = std::chrono::seconds(5), .stall_timeout = std::chrono::seconds(1)},
          .tries = 4,
          .first_wait = std::chrono::milliseconds(1),
          .longest_wait = std::chrono::milliseconds(4),
          .time = std::chrono::seconds(60),
          .part_size = 1000};
}

void FakeS3::set_fault(Fault fault) {
  const std::lock_guard lock(mutex_);
  fault_ = std::move(fault);
}

void FakeS3::set_access_key(const std::string& access_key) {
  const std::lock_guard lock(mutex_);
  access_key_ = access_key;
}

void FakeS3::set_object(const std::string& key, const Object& object) {
  const std::lock_guard lock(mutex_);
  objects_[key] = object;
}

std::map<std::string, FakeS3::Object> FakeS3::objects() const {
  const std::lock_guard lock(mutex_);
  return objects_;
}

std::size_t FakeS3::uploads() const {
  const std::lock_guard lock(mutex_);
  return uploads_.size();
}

std::vector<FakeS3::Request> FakeS3::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}

FakeS3::Reply FakeS3::error(int status, const std::string& code) {
  return {.status = status,
          .headers = {{"Content-Type", "application/xml"}},
          .body = absl::StrCat("<?xml version=\"1.0\"?><Error><Code>", code, "</Code><Message>no</Message></Error>")};
}

FakeS3::Reply FakeS3::answer(const Request& request) {
  const std::lock_guard lock(mutex_);
  requests_.push_back(request);
  if (fault_) {
    if (std::optional<Reply> reply = fault_(request)) return *std::move(reply);
  }
  const std::string signature = request.header("authorization");
  if (!absl::StrContains(signature, absl::StrCat("Credential=", access_key_, "/"))) return error(403, "InvalidAccessKeyId");
  for (const char* header : {"host", "x-amz-content-sha256", "x-amz-date"}) {
    if (!absl::StrContains(signature, header)) return error(403, "AccessDenied");
  }
  if (request.header("x-amz-content-sha256") != sha256_of(request.body)) return error(400, "XAmzContentSHA256Mismatch");
  absl::string_view path = request.path;
  if (!absl::ConsumePrefix(&path, kBucket)) return error(404, "NoSuchBucket");
  const std::string key = decoded(path);
  return request.query.empty() ? answer_object(request, key) : answer_upload(request, key);
}

FakeS3::Reply FakeS3::answer_object(const Request& request, const std::string& key) {
  if (request.method == "PUT") {
    objects_[key] = {.bytes = request.body, .sha256 = request.header(kSha256)};
    return {.headers = {{"ETag", etag_of(request.body)}}};
  }
  if (request.method == "DELETE") {
    objects_.erase(key);
    return {.status = 204};
  }
  const auto it = objects_.find(key);
  return it == objects_.end() ? error(404, "NoSuchKey") : read(request, it->second);
}

FakeS3::Reply FakeS3::read(const Request& request, const Object& object) const {
  const std::string etag = etag_of(object.bytes);
  Reply reply{.headers = {{"ETag", etag}}};
  if (!object.sha256.empty()) reply.headers[kSha256] = object.sha256;
  const std::string wanted = request.header("if-match");
  if (!wanted.empty() && wanted != etag) return error(412, "PreconditionFailed");
  std::string range = request.header("range");
  if (range.empty()) {
    reply.body = object.bytes;
    return reply;
  }
  const std::pair<std::string, std::string> ends = absl::StrSplit(range.substr(sizeof("bytes=") - 1), '-');
  std::size_t begin = 0, end = 0;
  if (!absl::SimpleAtoi(ends.first, &begin) || begin >= object.bytes.size()) return error(416, "InvalidRange");
  if (!absl::SimpleAtoi(ends.second, &end)) end = object.bytes.size() - 1;
  reply.status = 206;
  reply.body = object.bytes.substr(begin, end - begin + 1);
  reply.headers["Content-Range"] = absl::StrCat("bytes ", begin, "-", end, "/", object.bytes.size());
  return reply;
}

FakeS3::Reply FakeS3::answer_upload(const Request& request, const std::string& key) {
  if (request.query == "uploads=") {
    const std::string id = absl::StrCat("id&", ++begun_, "/+");  // as awkward as it may be
    uploads_[id] = {.key = key, .sha256 = request.header(kSha256), .parts = {}};
    return {.body = absl::StrCat("<InitiateMultipartUploadResult><UploadId>id&amp;", begun_,
                                 "/+</UploadId></InitiateMultipartUploadResult>")};
  }
  const auto it = uploads_.find(parameter(request.query, "uploadId"));
  if (it == uploads_.end() || it->second.key != key) return error(404, "NoSuchUpload");
  if (request.method == "DELETE") {
    uploads_.erase(it);
    return {.status = 204};
  }
  if (request.method == "PUT") {
    int part = 0;
    if (!absl::SimpleAtoi(parameter(request.query, "partNumber"), &part)) return error(400, "InvalidArgument");
    it->second.parts[part] = request.body;
    return {.headers = {{"ETag", etag_of(request.body)}}};
  }
  Object object{.bytes = "", .sha256 = it->second.sha256};
  std::string_view rest = request.body;
  for (const auto& [number, bytes] : it->second.parts) {
    const std::string etag = etag_of(bytes);
    const std::string line =
        absl::StrCat("<PartNumber>", number, "</PartNumber><ETag>&quot;", etag.substr(1, etag.size() - 2), "&quot;<");
    const std::size_t at = rest.find(line);
    if (at == std::string_view::npos) return error(400, "InvalidPart");
    rest.remove_prefix(at);
    object.bytes += bytes;
  }
  objects_[key] = object;
  uploads_.erase(it);
  return {.body = "<CompleteMultipartUploadResult><ETag>\"whole\"</ETag></CompleteMultipartUploadResult>"};
}

}  // namespace curvecast::server
