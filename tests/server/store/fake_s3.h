// A bucket in memory that answers as S3 does, as far as our store asks, and fails where a test wants it.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/store/s3_client.h"
#include "server/store/s3_settings.h"
#include "tests/server/store/http_server.h"

namespace curvecast::server {

class FakeS3 {
 public:
  using Request = HttpServer::Request;
  using Reply = HttpServer::Reply;
  /// What is answered instead, if anything.
  using Fault = std::function<std::optional<Reply>(const Request& request)>;
  struct Object {
    std::string bytes, sha256;  // the latter as its metadata have it
  };

  FakeS3() = default;

  std::string url() const { return server_.url(); }
  /// With keys that it takes.
  Environment environment() const;
  S3Endpoint endpoint() const;
  /// With waits that a test can wait for.
  static S3Options options();

  void set_fault(Fault fault);
  /// Other keys are refused: InvalidAccessKeyId.
  void set_access_key(const std::string& access_key);
  void set_object(const std::string& key, const Object& object);
  std::map<std::string, Object> objects() const;
  /// Multipart uploads that are neither complete nor aborted.
  std::size_t uploads() const;
  std::vector<Request> requests() const;
  int connections() const { return server_.connections(); }

  static Reply error(int status, const std::string& code);

 private:
  struct Upload {
    std::string key, sha256;
    std::map<int, std::string> parts;
  };
  Reply answer(const Request& request);
  Reply answer_object(const Request& request, const std::string& key);
  Reply answer_upload(const Request& request, const std::string& key);
  Reply read(const Request& request, const Object& object) const;

  mutable std::mutex mutex_;
  Fault fault_;
  std::string access_key_ = "AKEXAMPLE";
  std::map<std::string, Object> objects_;
  std::map<std::string, Upload> uploads_;
  int begun_ = 0;
  std::vector<Request> requests_;
  HttpServer server_{[this](const Request& request) { return answer(request); }};  // last
};

/// Bytes that differ from place to place.
std::string some_bytes(std::size_t size, std::uint64_t seed = 1);

}  // namespace curvecast::server
