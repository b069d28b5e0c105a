#include "server/store/s3_upload.h"

#include <absl/strings/str_cat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <utility>

#include "server/base/hash.h"
#include "server/store/s3_error.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kMaxParts = 10'000;
constexpr std::size_t kBlock = std::size_t{1} << 20;
constexpr std::size_t kMaxLost = 1000;
constexpr std::chrono::seconds kAbortTime(10);  // of a call's own, as the one that failed may have none left

std::string content_type() { return "content-type: application/octet-stream"; }

std::string metadata(const S3File& file) { return absl::StrCat(kSha256Header, ": ", file.sha256); }

std::string upload_query(const std::string& upload) { return absl::StrCat("uploadId=", percent_encoded(upload)); }

}  // namespace

absl::StatusOr<S3File> read_s3_file(int descriptor, std::uint64_t size, std::uint64_t least_part_size, const Deadline& deadline) {
  S3File out{.descriptor = descriptor, .size = size, .part_size = std::max(least_part_size, (size + kMaxParts - 1) / kMaxParts)};
  std::vector<char> block(std::min<std::uint64_t>(kBlock, size));
  Hasher all, part;
  for (std::uint64_t at = 0, in_part = 0; at < size;) {
    if (absl::Status status = deadline.check(); !status.ok()) return status;
    const std::uint64_t wanted = std::min({std::uint64_t{block.size()}, size - at, out.part_size - in_part});
    const ssize_t read = ::pread(descriptor, block.data(), wanted, static_cast<off_t>(at));
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) return absl::UnavailableError(absl::ErrnoToStatus(errno, "cannot read").message());
    if (read == 0) return absl::UnavailableError("it has become shorter");
    const std::string_view bytes(block.data(), static_cast<std::size_t>(read));
    all.update(bytes);
    part.update(bytes);
    at += bytes.size();
    in_part += bytes.size();
    if (in_part < out.part_size && at < size) continue;
    out.parts.push_back(part.sha256());
    part = Hasher();
    in_part = 0;
  }
  out.sha256 = all.sha256();
  return out;
}

absl::Status S3Upload::put(const std::string& key, const S3File& file, const Deadline& deadline) {
  absl::Status status = file.parts.size() <= 1 ? put_whole(key, file, deadline) : put_parts(key, file, deadline);
  if (status.ok()) abort_lost();
  return status;
}

absl::Status S3Upload::put_whole(const std::string& key, const S3File& file, const Deadline& deadline) {
  const S3Request request{.method = "PUT",
                          .key = key,
                          .headers = {content_type(), metadata(file)},
                          .file = file.descriptor,
                          .size = file.size,
                          .sha256 = file.sha256};
  const absl::StatusOr<HttpResponse> response = client_.send(request, deadline);
  return response.ok() ? check_is_s3(client_.name_of(key), *response) : response.status();
}

absl::Status S3Upload::put_parts(const std::string& key, const S3File& file, const Deadline& deadline) {
  absl::StatusOr<std::string> upload = begin(key, file, deadline);
  if (!upload.ok()) return upload.status();
  const Id id{.key = key, .upload = *std::move(upload)};
  std::vector<std::string> etags;
  absl::Status status;
  while (status.ok() && etags.size() < file.parts.size()) {
    absl::StatusOr<std::string> etag = put_part(id, file, etags.size(), deadline);
    status = etag.status();
    if (etag.ok()) etags.push_back(*std::move(etag));
  }
  if (status.ok()) {
    status = complete(id, etags, deadline);
    // Its answer may have been lost, and then there is no such upload any more.
    const bool may_be_done = absl::IsAborted(status) || absl::IsUnavailable(status);
    if (may_be_done && is_stored(key, file, deadline)) return absl::OkStatus();
  }
  if (!status.ok() && !abort(id).ok()) {
    const MutexLock lock(mutex_);
    if (lost_.size() < kMaxLost) lost_.push_back(id);
  }
  return absl::IsAborted(status) ? absl::UnavailableError(status.message()) : status;
}

absl::StatusOr<std::string> S3Upload::begin(const std::string& key, const S3File& file, const Deadline& deadline) {
  const S3Request request{.method = "POST", .key = key, .query = "uploads=", .headers = {content_type(), metadata(file)}};
  const absl::StatusOr<HttpResponse> response = client_.send(request, deadline);
  if (!response.ok()) return response.status();
  std::string upload = xml_text(response->body, "UploadId");
  if (upload.empty()) return absl::UnavailableError(absl::StrCat(client_.name_of(key), ": what answers there is no S3"));
  return upload;
}

absl::StatusOr<std::string> S3Upload::put_part(const Id& id, const S3File& file, std::size_t part, const Deadline& deadline) {
  const std::uint64_t offset = part * file.part_size;
  const S3Request request{.method = "PUT",
                          .key = id.key,
                          .query = absl::StrCat("partNumber=", part + 1, "&", upload_query(id.upload)),
                          .file = file.descriptor,
                          .offset = offset,
                          .size = std::min(file.part_size, file.size - offset),
                          .sha256 = file.parts[part]};
  const absl::StatusOr<HttpResponse> response = client_.send(request, deadline);
  if (!response.ok()) return response.status();
  if (absl::Status status = check_is_s3(client_.name_of(id.key), *response); !status.ok()) return status;
  return response->header("etag");
}

absl::Status S3Upload::complete(const Id& id, const std::vector<std::string>& etags, const Deadline& deadline) {
  std::string body = "<CompleteMultipartUpload xmlns=\"http://s3.amazonaws.com/doc/2006-03-01/\">";
  for (std::size_t part = 0; part < etags.size(); ++part) {
    absl::StrAppend(&body, "<Part><PartNumber>", part + 1, "</PartNumber><ETag>", xml_escaped(etags[part]), "</ETag></Part>");
  }
  absl::StrAppend(&body, "</CompleteMultipartUpload>");
  const S3Request request{.method = "POST",
                          .key = id.key,
                          .query = upload_query(id.upload),
                          .headers = {"content-type: application/xml"},
                          .body = std::move(body)};
  for (S3Retry retry(client_.options(), deadline);;) {
    const absl::StatusOr<HttpResponse> response = client_.send_once(request, deadline);
    absl::Status status = response.status();
    // S3 says 200 as soon as it begins, and how it went in the body.
    if (response.ok() && !xml_text(response->body, "Code").empty()) {
      status = s3_error(request.method, client_.name_of(id.key), *response);
    } else if (response.ok() && xml_text(response->body, "ETag").empty()) {
      status = absl::UnavailableError(absl::StrCat(client_.name_of(id.key), ": what answers there is no S3"));
    }
    if (status.ok()) return status;
    if (absl::Status end = retry.after(status); !end.ok()) return end;
  }
}

bool S3Upload::is_stored(const std::string& key, const S3File& file, const Deadline& deadline) {
  const absl::StatusOr<HttpResponse> response = client_.send({.method = "HEAD", .key = key}, deadline);
  return response.ok() && response->header(kSha256Header) == file.sha256 &&
         response->header("content-length") == absl::StrCat(file.size);
}

absl::Status S3Upload::abort(const Id& id) {
  const Deadline deadline(kAbortTime, nullptr);
  const absl::StatusOr<HttpResponse> response =
      client_.send({.method = "DELETE", .key = id.key, .query = upload_query(id.upload)}, deadline);
  // Where there is no such upload, nothing is left of it.
  return absl::IsAborted(response.status()) || absl::IsNotFound(response.status()) ? absl::OkStatus() : response.status();
}

void S3Upload::abort_lost() {
  std::vector<Id> lost;
  {
    const MutexLock lock(mutex_);
    lost.swap(lost_);
  }
  while (!lost.empty() && abort(lost.back()).ok()) lost.pop_back();
  const MutexLock lock(mutex_);
  lost_.insert(lost_.end(), lost.begin(), lost.end());
}

}  // namespace curvecast::server
