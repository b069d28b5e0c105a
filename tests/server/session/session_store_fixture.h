// A store of sessions whose preprocessing is in the test's hands, and somebody who waits for a session.
#pragma once

#include <gtest/gtest.h>
#include <spdlog/logger.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/log.h"
#include "server/session/session_store.h"

namespace curvecast::server {

inline constexpr auto kPatience = std::chrono::seconds(60);  // only a broken store waits that long

/// Notes what it is told, and waits for it.
class Waiter final : public SessionWaiter {
 public:
  explicit Waiter(bool wants_preview = true) : wants_preview_(wants_preview) {}
  void on_progress(std::string_view stage, double fraction) override {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(done_) << "progress after the end";
    progress_.emplace_back(stage, fraction);
    changed_.notify_all();
  }
  bool wants_preview() const override { return wants_preview_; }
  void on_preview(const std::shared_ptr<const Session>& preview) override {
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(preview_, nullptr) << "a second preview";
    EXPECT_FALSE(done_) << "a preview after the end";
    preview_ = preview;
  }
  void on_done(absl::StatusOr<std::shared_ptr<const Session>> session) override {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(done_) << "ended twice";
    done_ = std::move(session);
    changed_.notify_all();
  }

  absl::StatusOr<std::shared_ptr<const Session>> wait() {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, kPatience, [&] { return done_.has_value(); })) return absl::DeadlineExceededError("test");
    return *done_;
  }
  void wait_for_stage(const std::string& stage) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, kPatience, [&] { return !progress_.empty() && progress_.back().first == stage; }));
  }
  std::vector<std::pair<std::string, double>> progress() {
    const std::lock_guard lock(mutex_);
    return progress_;
  }
  std::shared_ptr<const Session> preview() {
    const std::lock_guard lock(mutex_);
    return preview_;
  }
  bool done() {
    const std::lock_guard lock(mutex_);
    return done_.has_value();
  }

 private:
  const bool wants_preview_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::pair<std::string, double>> progress_;
  std::shared_ptr<const Session> preview_;
  std::optional<absl::StatusOr<std::shared_ptr<const Session>>> done_;
};

/// The result of preprocessing: next to nothing.
inline Preprocessed tiny() {
  auto curve = std::make_shared<SurfaceCurve>();
  curve->x = {1};
  return {std::move(curve), {}};
}

/// A store of three sessions, with preprocessing that stays in its stage "cut" until it is let go or cancelled.
class SessionStoreFixture : public ::testing::Test {
 protected:
  absl::StatusOr<Preprocessed> preprocess(const ExecutionContext& context) {
    std::unique_lock lock(mutex_);
    ++runs_;
    lock.unlock();
    context.progress("read", 0);
    context.progress("read", 1);
    context.progress("cut", 0);
    lock.lock();
    while (!open_ && !context.cancelled()) changed_.wait_for(lock, std::chrono::milliseconds(1));
    if (context.cancelled()) {
      ++cancelled_;
      return context.check();
    }
    if (throws_) throw std::bad_alloc();
    if (!failure_.ok()) return failure_;
    context.progress("cut", 1);
    return tiny();
  }

  void set_open(bool open) {
    const std::lock_guard lock(mutex_);
    open_ = open;
    changed_.notify_all();
  }
  int runs() {
    const std::lock_guard lock(mutex_);
    return runs_;
  }
  int cancelled() {
    const std::lock_guard lock(mutex_);
    return cancelled_;
  }

  static MeshFiles mesh(const std::string& id) { return {std::make_shared<const Mesh>(MeshLabel{id}, MeshBytes()), {}}; }
  /// Mesh "m" with one companion.
  static MeshFiles mesh_with(const std::string& name, const std::string& companion) {
    MeshFiles files = mesh("m");
    files.companions[name] = mesh(companion).mesh;
    return files;
  }
  std::string make_ready(const std::string& mesh_id) {
    Waiter waiter;
    const auto id = store_->join(mesh(mesh_id), {}, &waiter);
    EXPECT_TRUE(id.ok()) << id.status();
    EXPECT_TRUE(waiter.wait().ok());
    return id.value_or("");
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false, throws_ = false;
  absl::Status failure_;
  int runs_ = 0, cancelled_ = 0;
  JobQueue queue_{{.max_waiting = 16}};
  std::optional<SessionStore> store_{std::in_place,
                                     queue_,
                                     [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context,
                                            const OnPreview&) { return preprocess(context); },
                                     SessionLimits{.sessions = 3},
                                     1,
                                     make_logger(false, false),
                                     SessionStore::Options{}};
};

}  // namespace curvecast::server
