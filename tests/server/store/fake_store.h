// A store in memory that can be full, away or stuck.
#pragma once

#include <absl/strings/str_cat.h>

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {

/// What a FakeStore and the test that looks into it share. Thread-safe.
class FakeFiles {
 public:
  using Files = std::map<std::string, std::string>;

  Files get() {
    const std::lock_guard lock(mutex_);
    return files_;
  }
  std::vector<std::string> names() {
    std::vector<std::string> out;
    for (const auto& [name, bytes] : get()) out.push_back(name);
    return out;
  }
  bool has(const std::string& name) { return get().contains(name); }
  void set(const std::string& name, std::string bytes) {
    const std::lock_guard lock(mutex_);
    files_[name] = std::move(bytes);
  }
  void erase(const std::string& name) {
    const std::lock_guard lock(mutex_);
    files_.erase(name);
  }
  /// All calls fail so, until it is OK again.
  void fail(absl::Status status) {
    const std::lock_guard lock(mutex_);
    failure_ = std::move(status);
  }
  /// Calls come back only when they are cancelled, or this is taken back.
  void hang(bool hangs) {
    const std::lock_guard lock(mutex_);
    hangs_ = hangs;
  }
  int calls() {
    const std::lock_guard lock(mutex_);
    return calls_;
  }
  /// How many files were got.
  int gets() {
    const std::lock_guard lock(mutex_);
    return gets_;
  }

 private:
  friend class FakeStore;
  std::mutex mutex_;
  Files files_;
  absl::Status failure_;
  bool hangs_ = false;
  int calls_ = 0, gets_ = 0;
};

class FakeStore final : public Store {
 public:
  explicit FakeStore(std::shared_ptr<FakeFiles> files) : files_(std::move(files)) {}

  absl::Status put(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) override {
    if (absl::Status failed = begin(cancel); !failed.ok()) return failed;
    if (!std::filesystem::exists(path)) return absl::NotFoundError(path);
    files_->set(name, testing::bytes_of(path));
    return absl::OkStatus();
  }
  absl::Status get(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) override {
    if (absl::Status failed = begin(cancel); !failed.ok()) return failed;
    const FakeFiles::Files files = files_->get();
    const auto found = files.find(name);
    if (found == files.end()) return absl::NotFoundError(name);
    testing::write_file(path, found->second);
    const std::lock_guard lock(files_->mutex_);
    ++files_->gets_;
    return absl::OkStatus();
  }
  absl::StatusOr<std::uint64_t> size(const std::string& name, const std::atomic<bool>* cancel) override {
    if (absl::Status failed = begin(cancel); !failed.ok()) return failed;
    const FakeFiles::Files files = files_->get();
    const auto found = files.find(name);
    if (found == files.end()) return absl::NotFoundError(name);
    return found->second.size();
  }
  absl::Status remove(const std::string& name, const std::atomic<bool>* cancel) override {
    if (absl::Status failed = begin(cancel); !failed.ok()) return failed;
    files_->erase(name);
    return absl::OkStatus();
  }

 private:
  absl::Status begin(const std::atomic<bool>* cancel) {
    for (bool is_first = true;; is_first = false) {
      {
        const std::lock_guard lock(files_->mutex_);
        files_->calls_ += is_first;
        if (!files_->hangs_) return files_->failure_;
      }
      if (cancel != nullptr && *cancel) return absl::CancelledError("cancelled");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  const std::shared_ptr<FakeFiles> files_;
};

}  // namespace curvecast::server
