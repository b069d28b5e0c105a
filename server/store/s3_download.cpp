#include "server/store/s3_download.h"

#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>

#include <cstdint>
#include <span>
#include <utility>

#include "core/storage/atomic_file.h"
#include "server/base/hash.h"
#include "server/store/s3_error.h"
#include "server/store/s3_upload.h"

namespace curvecast::server {
namespace {

constexpr int kPartialContent = 206;

/// Of the file that is written. What else it may be, such as NotFound, would be taken for S3's.
absl::Status of_disk(const absl::Status& status) {
  return status.ok() || absl::IsResourceExhausted(status) ? status : absl::UnavailableError(status.message());
}

/// A file on its way, through as many responses as it takes.
class Download {
 public:
  Download(AtomicFile& file, std::uint64_t rate, Deadline& deadline) : file_(file), rate_(rate), deadline_(deadline) {}

  /// For the next try.
  S3Request request(const std::string& key) {
    is_begun_ = false;
    S3Request out{.method = "GET", .key = key};
    if (at_ > 0) out.headers = {absl::StrCat("if-match: ", etag_), absl::StrCat("range: bytes=", at_, "-")};
    out.take = [this](const HttpResponse& head, std::string_view bytes) { return take(head, bytes); };
    return out;
  }

  absl::Status take(const HttpResponse& head, std::string_view bytes) {
    if (absl::Status status = begin(head); !status.ok()) return status;
    if (absl::Status status = of_disk(file_.write_at(at_, std::as_bytes(std::span(bytes)))); !status.ok()) return status;
    hasher_.update(bytes);
    at_ += bytes.size();
    return absl::OkStatus();
  }

  /// Whether a response that has come to its end has brought all. Unavailable: other bytes than were put, and from the beginning
  /// again. DataLoss: for the second time.
  absl::Status finish(const HttpResponse& response) {
    if (absl::Status status = begin(response); !status.ok()) return status;  // of an empty object
    const std::string wanted = response.header(kSha256Header);
    const std::string sha256 = hasher_.sha256();
    if (wanted.empty() || wanted == sha256) return absl::OkStatus();
    const bool is_again = wrong_ == sha256;
    wrong_ = sha256;
    at_ = 0;
    constexpr char kWhy[] = "what has come is not what was put: its SHA-256 is another one";
    return is_again ? absl::DataLossError(kWhy) : absl::UnavailableError(kWhy);
  }

  std::uint64_t bytes() const { return at_; }
  /// What there is so far goes with nothing that comes.
  void restart() { at_ = 0; }

 private:
  absl::Status begin(const HttpResponse& head) {
    if (std::exchange(is_begun_, true)) return absl::OkStatus();
    if (absl::Status status = check_is_s3("its answer", head); !status.ok()) return status;
    std::uint64_t length = 0;
    if (absl::SimpleAtoi(head.header("content-length"), &length)) deadline_.allow(length, rate_);
    const bool goes_on = head.status == kPartialContent && at_ > 0 && head.header("etag") == etag_ &&
                         absl::StartsWith(head.header("content-range"), absl::StrCat("bytes ", at_, "-"));
    if (goes_on) return absl::OkStatus();
    if (head.status == kPartialContent) return absl::UnavailableError("it came with another part than was asked for");
    at_ = 0;
    etag_ = head.header("etag");
    hasher_ = Hasher();
    return of_disk(file_.resize(0));
  }

  AtomicFile& file_;
  const std::uint64_t rate_;
  Deadline& deadline_;
  bool is_begun_ = false;
  std::uint64_t at_ = 0;
  std::string etag_, wrong_;
  Hasher hasher_;  // of all before `at_`
};

}  // namespace

absl::Status get_s3_object(S3Client& client, const std::string& key, const std::string& path, Deadline& deadline) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return of_disk(file.status());
  Download download(*file, client.options().rate, deadline);
  for (S3Retry retry(client.options(), deadline);;) {
    const std::uint64_t before = download.bytes();
    const absl::StatusOr<HttpResponse> response = client.send_once(download.request(key), deadline);
    absl::Status status = response.status();
    if (response.ok()) {
      status = download.finish(*response);
      if (status.ok()) return of_disk(file->publish());
      status = absl::Status(status.code(), absl::StrCat(client.name_of(key), ": ", status.message()));
    } else if (before > 0 && absl::IsPermissionDenied(status)) {
      // HTTP 412 or 416: it is another object by now. What else it may be, comes again.
      download.restart();
      status = absl::UnavailableError(status.message());
    }
    if (download.bytes() > before) retry.reset();
    if (absl::Status end = retry.after(status); !end.ok()) return end;
  }
}

}  // namespace curvecast::server
