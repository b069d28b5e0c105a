#include "server/base/admission.h"

#include <absl/strings/str_cat.h>

#include <utility>

namespace curvecast::server {

Admission::Admission(std::string what, std::size_t most, std::size_t most_of_client)
    : what_(std::move(what)), most_(most), most_of_client_(most_of_client) {}

Admission::Ticket::~Ticket() {
  if (from_ == nullptr) return;
  const MutexLock lock(from_->mutex_);
  --from_->count_;
  const auto found = from_->of_client_.find(client_);
  if (--found->second == 0) from_->of_client_.erase(found);
}

absl::StatusOr<Admission::Ticket> Admission::admit(const std::string& client) {
  const MutexLock lock(mutex_);
  if (count_ >= most_) {
    ++refused_;
    return absl::ResourceExhaustedError(
        absl::StrCat("the server has ", count_, " ", what_, ", as many as it takes; try again later"));
  }
  std::size_t& count = of_client_[client];
  if (count >= most_of_client_) {
    ++refused_;
    return absl::ResourceExhaustedError(absl::StrCat("you have ", count, " ", what_, ", as many as a client may; end one first"));
  }
  ++count;
  ++count_;
  return Ticket(shared_from_this(), client);
}

std::size_t Admission::count() const {
  const MutexLock lock(mutex_);
  return count_;
}

std::string client_of_peer(const std::string& peer) { return peer.substr(0, peer.rfind(':')); }

}  // namespace curvecast::server
