#include "server/net/connection_table.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace curvecast::server {
namespace {

// A full table looks for closed connections no more often: it takes a system call for each.
constexpr std::chrono::milliseconds kLookInterval{100};

/// 0: the descriptor is that of no socket.
ino_t socket_inode(int descriptor) {
  struct stat info = {};
  return ::fstat(descriptor, &info) == 0 && S_ISSOCK(info.st_mode) ? info.st_ino : 0;
}

/// Ends a connection that somebody else serves, who hears of it as if the other side had gone. A copy of the descriptor keeps the
/// socket that was looked at: the descriptor itself may become another one's at any moment.
void end(int descriptor, ino_t inode) {
  const int copy = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  if (copy < 0) return;  // it has gone already
  if (socket_inode(copy) == inode) ::shutdown(copy, SHUT_RDWR);
  ::close(copy);
}

}  // namespace

bool ConnectionTable::add(int descriptor, const std::string& peer, const std::string& client) {
  const ino_t inode = socket_inode(descriptor);
  const MutexLock lock(mutex_);
  // Whoever had its descriptor or its address has gone.
  if (const auto old = by_descriptor_.find(descriptor); old != by_descriptor_.end()) forget(old->second);
  if (const auto old = by_peer_.find(peer); old != by_peer_.end()) forget(old->second);
  if (size() >= most_ && !make_room()) {
    ++refused_;
    return false;
  }
  silent_.push_back({descriptor, inode, peer, client});
  by_descriptor_[descriptor] = by_peer_[peer] = std::prev(silent_.end());
  return true;
}

std::string ConnectionTable::client_of(const std::string& peer) const {
  const MutexLock lock(mutex_);
  const auto found = by_peer_.find(peer);
  return found == by_peer_.end() || found->second->client.empty() ? peer : found->second->client;
}

void ConnectionTable::note_call(const std::string& peer) {
  const MutexLock lock(mutex_);
  const auto found = by_peer_.find(peer);
  if (found == by_peer_.end() || found->second->has_called) return;
  found->second->has_called = true;
  callers_.splice(callers_.end(), silent_, found->second);
}

std::size_t ConnectionTable::count() {
  const MutexLock lock(mutex_);
  forget_closed();
  return size();
}

std::uint64_t ConnectionTable::ended() const {
  const MutexLock lock(mutex_);
  return ended_;
}

std::uint64_t ConnectionTable::refused() const {
  const MutexLock lock(mutex_);
  return refused_;
}

void ConnectionTable::forget(Connections::iterator connection) {
  by_descriptor_.erase(connection->descriptor);
  by_peer_.erase(connection->peer);
  (connection->has_called ? callers_ : silent_).erase(connection);
}

void ConnectionTable::forget_closed() {
  looked_ = Clock::now();
  for (Connections* connections : {&silent_, &callers_}) {
    for (auto next = connections->begin(); next != connections->end();) {
      const auto connection = next++;
      if (socket_inode(connection->descriptor) != connection->inode) forget(connection);
    }
  }
}

bool ConnectionTable::make_room() {
  if (Clock::now() - looked_ >= kLookInterval) forget_closed();
  if (size() < most_) return true;
  if (silent_.empty()) return false;
  end(silent_.front().descriptor, silent_.front().inode);
  forget(silent_.begin());
  ++ended_;
  return true;
}

}  // namespace curvecast::server
