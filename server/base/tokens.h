// Who may call: bearer tokens from a file.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace curvecast::server {

/// Immutable: thread-safe.
class Tokens {
 public:
  using Clock = std::chrono::system_clock;

  /// A line for each token: the name of who has it, the token's SHA-256 as 64 hexadecimal digits (`printf %s TOKEN | sha256sum`),
  /// and, where it expires, the second, counted from 1970, from which on it is refused. Empty lines and those that begin with #
  /// are skipped. NotFound for a file that cannot be read; InvalidArgument names the line at fault, never what stands there.
  static absl::StatusOr<std::shared_ptr<const Tokens>> read(const std::string& path);
  static absl::StatusOr<std::shared_ptr<const Tokens>> parse(std::string_view text, const std::string& name);

  struct Holder {
    std::string name;
    std::string digest;  // SHA-256 of the token
  };
  /// Who has the token of an `authorization` header ("Bearer TOKEN"). Unauthenticated: none, an unknown or an expired one.
  absl::StatusOr<Holder> authenticate(std::string_view authorization, Clock::time_point now = Clock::now()) const;

  /// Whether somebody whom these tokens or earlier ones have named still has that token. Unauthenticated: not any more.
  absl::Status check(const Holder& holder, Clock::time_point now = Clock::now()) const;

  std::size_t size() const { return by_digest_.size(); }

 private:
  struct Entry {
    std::string name;
    Clock::time_point expires = Clock::time_point::max();
  };
  /// Unauthenticated as of authenticate().
  absl::StatusOr<std::string_view> find(std::string_view digest, Clock::time_point now) const;

  std::map<std::string, Entry, std::less<>> by_digest_;  // SHA-256: how long a search takes tells nothing about a token
};

}  // namespace curvecast::server
