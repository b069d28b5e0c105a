// The connections of a port, so that there are never too many of them.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <string>
#include <unordered_map>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Thread-safe. Knows the sockets of connections that others serve and close. Where there are as many as there may be, the oldest
/// one that has made no call gives way to a new one: so whoever connects and says nothing, or half of a handshake, keeps nobody
/// out.
class ConnectionTable {
 public:
  explicit ConnectionTable(std::size_t most) : most_(most) {}

  /// Counts the connection of a socket, from now until the socket is closed. `client`: for whom its peer, a proxy, has opened it;
  /// empty: for itself. False, and it is refused: all others have made calls.
  bool add(int descriptor, const std::string& peer, const std::string& client = {}) ABSL_LOCKS_EXCLUDED(mutex_);
  /// The client for whom a peer has opened its connection: the peer itself, unless it is a proxy that said so.
  std::string client_of(const std::string& peer) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// The connection of this peer has made a call that was let in. Does nothing for peers that have none here.
  void note_call(const std::string& peer) ABSL_LOCKS_EXCLUDED(mutex_);
  /// How many there are at this moment: looks at each.
  std::size_t count() ABSL_LOCKS_EXCLUDED(mutex_);

  /// So far: connections that gave way, and those refused.
  std::uint64_t ended() const ABSL_LOCKS_EXCLUDED(mutex_);
  std::uint64_t refused() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  using Clock = std::chrono::steady_clock;
  struct Connection {
    int descriptor;
    ino_t inode;  // tells this socket from a later one with its descriptor
    std::string peer;
    std::string client;  // empty: the peer
    bool has_called = false;
  };
  using Connections = std::list<Connection>;

  void forget(Connections::iterator connection) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Forgets those whose sockets have been closed.
  void forget_closed() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// False: there is no room.
  bool make_room() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::size_t size() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return silent_.size() + callers_.size(); }

  const std::size_t most_;
  mutable Mutex mutex_;
  Connections silent_ ABSL_GUARDED_BY(mutex_);   // that have made no call, by age
  Connections callers_ ABSL_GUARDED_BY(mutex_);  // those that have
  std::unordered_map<int, Connections::iterator> by_descriptor_ ABSL_GUARDED_BY(mutex_);
  std::unordered_map<std::string, Connections::iterator> by_peer_ ABSL_GUARDED_BY(mutex_);
  Clock::time_point looked_ ABSL_GUARDED_BY(mutex_) = {};  // for closed ones
  std::uint64_t ended_ ABSL_GUARDED_BY(mutex_) = 0, refused_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace curvecast::server
