#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <curl/curl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <new>
#include <utility>

#include "server/store/http_transfer.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMaxBody = std::size_t{64} << 10;
constexpr std::size_t kMaxIdle = 16;
constexpr long kBuffer = 256L << 10;
constexpr long kLeastRate = 1024;  // bytes a second

/// One request under way, as libcurl's callbacks see it. They are called from C: no exception may leave them.
struct Exchange {
  const HttpRequest& request;
  const HttpHooks& hooks;
  CURL* handle = nullptr;
  HttpResponse response = {};
  std::uint64_t sent = 0;    // bytes of the file
  absl::Status status = {};  // why a callback has ended it

  bool is_success() const { return response.status / 100 == 2; }

  /// Whether all is well.
  template <class Work>
  bool guard(const Work& work) {
    try {
      status.Update(work());
    } catch (const std::bad_alloc&) {
      status.Update(absl::ResourceExhaustedError("there is no memory for an answer from the network"));
    }
    return status.ok();
  }

  absl::Status take_header(absl::string_view line) {
    if (absl::StartsWith(line, "HTTP/")) {  // the first line of a response; another may have come before: 100 Continue
      response = {};
      return absl::OkStatus();
    }
    const std::size_t colon = line.find(':');
    if (colon == absl::string_view::npos) return absl::OkStatus();
    response.headers[absl::AsciiStrToLower(line.substr(0, colon))] =
        std::string(absl::StripAsciiWhitespace(line.substr(colon + 1)));
    return absl::OkStatus();
  }

  absl::Status take_body(std::string_view bytes) {
    long status_code = 0;
    curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status_code);
    response.status = static_cast<int>(status_code);
    if (is_success() && hooks.take) return hooks.take(response, bytes);
    response.body.append(bytes.substr(0, kMaxBody - response.body.size()));
    return absl::OkStatus();
  }

  absl::Status send(char* to, std::size_t room, std::size_t& count) {
    const std::uint64_t left = request.size - sent;
    if (left == 0) return absl::OkStatus();
    ssize_t read = 0;
    do {
      read = ::pread(request.file, to, std::min<std::uint64_t>(room, left), static_cast<off_t>(request.offset + sent));
    } while (read < 0 && errno == EINTR);
    if (read < 0) return absl::UnavailableError(absl::ErrnoToStatus(errno, "cannot read the file that is being sent").message());
    if (read == 0) return absl::UnavailableError("the file that is being sent has become shorter");
    sent += static_cast<std::uint64_t>(read);
    count = static_cast<std::size_t>(read);
    return absl::OkStatus();
  }
};

std::size_t on_header(char* bytes, std::size_t size, std::size_t count, void* self) {
  auto& exchange = *static_cast<Exchange*>(self);
  return exchange.guard([&] { return exchange.take_header({bytes, size * count}); }) ? size * count : 0;
}

std::size_t on_body(char* bytes, std::size_t size, std::size_t count, void* self) {
  auto& exchange = *static_cast<Exchange*>(self);
  return exchange.guard([&] { return exchange.take_body({bytes, size * count}); }) ? size * count : 0;
}

std::size_t on_send(char* to, std::size_t size, std::size_t count, void* self) {
  auto& exchange = *static_cast<Exchange*>(self);
  std::size_t sent = 0;
  return exchange.guard([&] { return exchange.send(to, size * count, sent); }) ? sent : CURL_READFUNC_ABORT;
}

/// A kept connection may turn out to be closed: then all is sent again.
int on_seek(void* self, curl_off_t offset, int origin) {
  if (origin != SEEK_SET) return CURL_SEEKFUNC_CANTSEEK;
  static_cast<Exchange*>(self)->sent = static_cast<std::uint64_t>(offset);
  return CURL_SEEKFUNC_OK;
}

int on_progress(void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  auto& exchange = *static_cast<Exchange*>(self);
  if (!exchange.hooks.check) return 0;
  return exchange.guard([&] { return exchange.hooks.check(); }) ? 0 : 1;
}

struct FreeList {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};

/// Sets options of a handle; the first that fails counts.
class Setter {
 public:
  explicit Setter(CURL* handle) : handle_(handle) {}
  template <class Value>
  void operator()(CURLoption option, Value value) {
    if (result_ == CURLE_OK) result_ = curl_easy_setopt(handle_, option, value);
  }
  CURLcode result() const { return result_; }

 private:
  CURL* handle_;
  CURLcode result_ = CURLE_OK;
};

void set_connection(Setter& set, const HttpOptions& options) {
  set(CURLOPT_NOSIGNAL, 1L);
  set(CURLOPT_PROTOCOLS_STR, "http,https");
  set(CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_1_1));
  set(CURLOPT_SSLVERSION, static_cast<long>(CURL_SSLVERSION_TLSv1_2));
  if (!options.ca_bundle.empty()) set(CURLOPT_CAINFO, options.ca_bundle.c_str());
  set(CURLOPT_TCP_KEEPALIVE, 1L);
  set(CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(options.connect_timeout.count()));
  set(CURLOPT_LOW_SPEED_LIMIT, kLeastRate);
  set(CURLOPT_LOW_SPEED_TIME, static_cast<long>(options.stall_timeout.count()));
  set(CURLOPT_BUFFERSIZE, kBuffer);
  set(CURLOPT_UPLOAD_BUFFERSIZE, kBuffer);
}

void set_request(Setter& set, const HttpRequest& request) {
  set(CURLOPT_URL, request.url.c_str());
  set(CURLOPT_PATH_AS_IS, 1L);
  if (request.method == "HEAD") {
    set(CURLOPT_NOBODY, 1L);
  } else if (request.method == "PUT") {
    set(CURLOPT_UPLOAD, 1L);
    set(CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(request.size));
  } else if (request.method == "POST") {
    set(CURLOPT_POST, 1L);
    set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(request.body.size()));
    set(CURLOPT_POSTFIELDS, request.body.data());
  } else {
    set(CURLOPT_CUSTOMREQUEST, request.method.c_str());
  }
  if (request.signature != nullptr) {
    set(CURLOPT_AWS_SIGV4, absl::StrCat("aws:amz:", request.signature->region, ":s3").c_str());
    set(CURLOPT_USERNAME, request.signature->access_key.c_str());
    set(CURLOPT_PASSWORD, request.signature->secret.c_str());
  }
}

void set_callbacks(Setter& set, Exchange& exchange, char* why) {
  set(CURLOPT_ERRORBUFFER, why);
  set(CURLOPT_HEADERFUNCTION, on_header);
  set(CURLOPT_HEADERDATA, &exchange);
  set(CURLOPT_WRITEFUNCTION, on_body);
  set(CURLOPT_WRITEDATA, &exchange);
  set(CURLOPT_READFUNCTION, on_send);
  set(CURLOPT_READDATA, &exchange);
  set(CURLOPT_SEEKFUNCTION, on_seek);
  set(CURLOPT_SEEKDATA, &exchange);
  set(CURLOPT_NOPROGRESS, 0L);
  set(CURLOPT_XFERINFOFUNCTION, on_progress);
  set(CURLOPT_XFERINFODATA, &exchange);
}

}  // namespace

std::string HttpResponse::header(const std::string& name) const {
  const auto it = headers.find(name);
  return it == headers.end() ? std::string() : it->second;
}

void HttpTransfer::Free::operator()(void* handle) const { curl_easy_cleanup(handle); }

HttpTransfer::HttpTransfer(HttpOptions options) : options_(std::move(options)) {
  // For the whole process and for good: others in it may use libcurl too. Thread-safe since libcurl 7.84.
  static const CURLcode initialised = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (initialised != CURLE_OK) throw std::bad_alloc();
}

HttpTransfer::~HttpTransfer() = default;

HttpTransfer::Handle HttpTransfer::take_handle() {
  const MutexLock lock(mutex_);
  if (idle_.empty()) return Handle(curl_easy_init());
  Handle handle = std::move(idle_.back());  // the one whose connection is most likely to be open still
  idle_.pop_back();
  return handle;
}

void HttpTransfer::give_back(Handle handle) {
  curl_easy_reset(handle.get());  // forgets keys, keeps connections
  const MutexLock lock(mutex_);
  if (idle_.size() < kMaxIdle) idle_.push_back(std::move(handle));
}

absl::StatusOr<HttpResponse> HttpTransfer::run(const HttpRequest& request, const HttpHooks& hooks) {
  Handle handle = take_handle();
  if (handle == nullptr) return absl::ResourceExhaustedError("there is no memory for a connection");
  std::unique_ptr<curl_slist, FreeList> headers;
  for (const std::string& header : request.headers) {
    curl_slist* longer = curl_slist_append(headers.get(), header.c_str());
    if (longer == nullptr) return absl::ResourceExhaustedError("there is no memory for a request");
    (void)headers.release();
    headers.reset(longer);
  }
  Exchange exchange{.request = request, .hooks = hooks, .handle = handle.get()};
  std::array<char, CURL_ERROR_SIZE> why = {};
  Setter set(handle.get());
  set_connection(set, options_);
  set_request(set, request);
  set_callbacks(set, exchange, why.data());
  set(CURLOPT_HTTPHEADER, headers.get());
  const CURLcode result = set.result() == CURLE_OK ? curl_easy_perform(handle.get()) : set.result();
  long status_code = 0;
  curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &status_code);
  exchange.response.status = static_cast<int>(status_code);
  give_back(std::move(handle));
  if (!exchange.status.ok()) return exchange.status;
  if (result == CURLE_OK) return std::move(exchange.response);
  if (result == CURLE_OUT_OF_MEMORY) return absl::ResourceExhaustedError("there is no memory for a request");
  return absl::UnavailableError(why[0] != '\0' ? why.data() : curl_easy_strerror(result));
}

std::string percent_encoded(const std::string& text) {
  const std::unique_ptr<char, decltype(&curl_free)> encoded(curl_easy_escape(nullptr, text.data(), static_cast<int>(text.size())),
                                                            &curl_free);
  if (encoded == nullptr) throw std::bad_alloc();
  return encoded.get();
}

}  // namespace curvecast::server
