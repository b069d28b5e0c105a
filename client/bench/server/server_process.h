// A server in a process of its own, whose time and memory can be told from those of its clients.
#pragma once

#include <absl/status/statusor.h>
#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <string>

namespace curvecast::cli::bench {

class ServerProcess {
 public:
  /// Runs `command` (empty: curvecast, from the folder of this program) as a server on a free port of the loopback. Unavailable
  /// where it does not come up.
  static absl::StatusOr<std::unique_ptr<ServerProcess>> start(const std::string& command, int threads);
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;
  ~ServerProcess();  // stops it, and waits for its end

  const std::string& address() const { return address_; }  // host:port
  double cpu_milliseconds() const;                         // used so far by all of its threads; to 10 ms
  std::uint64_t resident_bytes() const;
  std::uint64_t peak_bytes() const;  // the most that were resident so far

 private:
  ServerProcess(pid_t pid, std::string address) : pid_(pid), address_(std::move(address)) {}

  pid_t pid_;
  std::string address_;
};

}  // namespace curvecast::cli::bench
