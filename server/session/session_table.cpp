#include "server/session/session_table.h"

#include <absl/strings/str_cat.h>

#include <algorithm>

#include "core/base/memory_claim.h"
#include "server/session/session_jobs.h"

namespace curvecast::server {
namespace {

std::uint64_t bytes_of(const SessionTable::Entry& entry) {
  return entry.info.session != nullptr ? entry.info.session->memory_bytes() : 0;
}

}  // namespace

SessionTable::Entry* SessionTable::find(const std::string& id) {
  const auto found = entries_.find(id);
  return found == entries_.end() ? nullptr : &found->second;
}

SessionTable::Entry* SessionTable::use(const std::string& id) {
  Entry* const entry = find(id);
  if (entry == nullptr) return nullptr;
  entry->last_used = ++clock_;
  entry->used_at = Clock::now();
  return entry;
}

void SessionTable::insert(Entry entry) {
  const std::string id = entry.info.id;
  entries_.emplace(id, std::move(entry));
  use(id);
}

SessionTable::Entry SessionTable::take(const std::string& id) {
  const auto found = entries_.find(id);
  Entry entry = std::move(found->second);
  entries_.erase(found);
  return entry;
}

absl::Status SessionTable::make_room(Sessions& evicted) {
  const Eviction eviction = choose({limits_.sessions - 1, limits_.bytes});
  if (!eviction.is_enough) {
    return absl::ResourceExhaustedError(
        absl::StrCat("this server holds ", limits_.sessions, " sessions of ", describe_bytes(static_cast<double>(limits_.bytes)),
                     " together at most, and those in use, pinned or in the making are ", eviction.sessions, " of ",
                     describe_bytes(static_cast<double>(eviction.bytes)), "; close one or try again later"));
  }
  evicted = take(eviction);
  return absl::OkStatus();
}

SessionTable::Sessions SessionTable::evict_excess() { return take(choose(limits_)); }

Eviction SessionTable::choose(const SessionLimits& limits) const {
  std::vector<Resident> residents;
  for (const auto& [id, entry] : entries_) {
    residents.push_back({id, entry.last_used, bytes_of(entry), entry.is_idle() && !entry.info.pinned, is_unsaved(id)});
  }
  return choose_evicted(std::move(residents), limits);
}

SessionTable::Sessions SessionTable::take(const Eviction& eviction) {
  Sessions evicted;
  for (const std::string& id : eviction.ids) evicted.push_back(take(id).info.session);
  return evicted;
}

SessionTable::Sessions SessionTable::evict_bytes(std::uint64_t bytes) {
  const std::uint64_t all = memory_bytes();
  return take(choose({.sessions = limits_.sessions, .bytes = all - std::min(all, bytes)}));
}

absl::Status SessionTable::may_make(const std::string& caller) const {
  const auto count = std::ranges::count_if(entries_, [&](const auto& entry) {
    return entry.second.job != nullptr && entry.second.job->is_made && entry.second.job->caller == caller;
  });
  if (static_cast<std::size_t>(count) < limits_.in_making_of_one) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("you have ", count, " sessions in the making, as many as a client may; wait until one is ready"));
}

absl::Status SessionTable::may_pin(const Session& session) const {
  std::uint64_t sessions = 1, bytes = session.memory_bytes();
  for (const auto& [id, entry] : entries_) {
    if (!entry.info.pinned || entry.info.session == nullptr) continue;
    ++sessions;
    bytes += bytes_of(entry);
  }
  const std::uint64_t most = std::max<std::uint64_t>(1, limits_.sessions / 2);
  if (sessions <= most && bytes <= limits_.bytes / 2) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("no more than half of what the server holds may be pinned, ", most,
                                                   " sessions and ", limits_.bytes / 2, " bytes; unpin another one"));
}

SessionTable::Sessions SessionTable::take_unused(Clock::time_point now) {
  std::vector<std::string> unused;
  for (auto& [id, entry] : entries_) {
    if (!entry.is_idle()) entry.used_at = now;
    const std::chrono::duration<double> idle = now - entry.used_at;
    if (entry.info.time_to_live > 0 && idle.count() > entry.info.time_to_live && !is_unsaved(id)) unused.push_back(id);
  }
  Sessions taken;
  for (const std::string& id : unused) taken.push_back(take(id).info.session);
  return taken;
}

std::vector<std::string> SessionTable::used_since(Clock::time_point then) const {
  std::vector<std::string> used;
  for (const auto& [id, entry] : entries_) {
    if (!entry.is_idle() || entry.used_at >= then) used.push_back(id);
  }
  return used;
}

std::vector<SessionInfo> SessionTable::list(const std::string& after, std::size_t most,
                                            const std::function<bool(const Entry&)>& is_wanted) const {
  std::vector<SessionInfo> out;
  for (auto it = entries_.upper_bound(after); it != entries_.end() && out.size() < most; ++it) {
    if (is_wanted(it->second)) out.push_back(info_of(it->second));
  }
  return out;
}

SessionInfo SessionTable::info_of(const Entry& entry) {
  SessionInfo info = entry.info;
  info.state = entry.job == nullptr   ? SessionState::kReady
               : entry.job->has_begun ? SessionState::kPreprocessing
                                      : SessionState::kQueued;
  return info;
}

std::vector<std::shared_ptr<SessionJob>> SessionTable::jobs() const {
  std::vector<std::shared_ptr<SessionJob>> out;
  for (const auto& [id, entry] : entries_) {
    if (entry.job != nullptr) out.push_back(entry.job);
  }
  return out;
}

std::uint64_t SessionTable::memory_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& [id, entry] : entries_) bytes += bytes_of(entry);
  return bytes;
}

}  // namespace curvecast::server
