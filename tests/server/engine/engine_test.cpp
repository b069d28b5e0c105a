// Conversations while the curve beneath them becomes finer and is saved, loaded, closed: all of a server's threads, without gRPC,
// so that ThreadSanitizer sees every lock.
#include "server/engine/engine.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <future>
#include <latch>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/base/log.h"
#include "server/server.h"
#include "tests/server/eventually.h"
#include "tests/server/frame/frame_points.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/views.h"

namespace curvecast::server {
namespace {

constexpr auto kPatience = std::chrono::seconds(240);  // only a broken engine waits that long
constexpr auto kPause = std::chrono::milliseconds(5);  // leaves the refiner, which gives way to everybody, its turn
constexpr std::uint64_t kMadeFor = 300;
constexpr int kClients = 4;

class Waiter final : public SessionWaiter {
 public:
  void on_progress(std::string_view, double) override {}
  void on_done(absl::StatusOr<std::shared_ptr<const Session>> session) override { done_.set_value(std::move(session)); }
  absl::StatusOr<std::shared_ptr<const Session>> wait() { return done_.get_future().get(); }

 private:
  std::promise<absl::StatusOr<std::shared_ptr<const Session>>> done_;
};

/// The far end of a conversation.
class Client final : public ClientStream::Transport {
 public:
  Client(Engine& engine, const std::string& session_id)
      : stream_(engine.make_stream(this, {.name = "caller", .address = "client"}).value()) {
    v1::StreamViewsRequest request;
    request.mutable_open()->set_session_id(session_id);
    stream_->receive(request);
  }

  void send(v1::StreamViewsResponse response) override {
    const std::lock_guard lock(mutex_);
    inbox_.push_back(std::move(*response.mutable_frame()));
    changed_.notify_all();
  }
  void end(const absl::Status& status) override {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(ended_) << "ended twice";
    ended_ = status;
    changed_.notify_all();
  }

  /// Asks for a view of a sphere from a side, with far more points there than elsewhere.
  void look(std::uint64_t points) {
    v1::StreamViewsRequest request;
    request.mutable_view()->set_sequence(++sequence_);
    v1::SampleRequest& sample = *request.mutable_view()->mutable_sample();
    sample.set_points(points);
    sample.add_density()->mutable_view();
    sample.add_cameras()->mutable_eye()->set_z(3);
    stream_->receive(request);
  }
  /// Takes and acknowledges a frame; nothing once the conversation is over.
  std::optional<v1::PointFrame> next() {
    std::optional<v1::PointFrame> frame;
    {
      std::unique_lock lock(mutex_);
      EXPECT_TRUE(changed_.wait_for(lock, kPatience, [this] { return ended_ || !inbox_.empty(); }));
      if (inbox_.empty()) return std::nullopt;
      frame = std::move(inbox_.front());
      inbox_.pop_front();
    }
    EXPECT_FALSE(frame->has_error()) << frame->error().message();
    stream_->sent(true);
    v1::StreamViewsRequest request;
    request.mutable_ack()->set_sequence(frame->sequence());
    stream_->receive(request);
    return frame;
  }
  absl::Status leave() {
    stream_->half_close();
    while (next()) continue;
    const std::lock_guard lock(mutex_);
    return ended_.value_or(absl::DeadlineExceededError("no end"));
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<v1::PointFrame> inbox_;
  std::optional<absl::Status> ended_;
  std::uint64_t sequence_ = 0;
  const std::shared_ptr<ClientStream> stream_;
};

class EngineTest : public ::testing::Test {
 protected:
  ~EngineTest() override { stop(); }

  // In the order of a server's shutdown.
  void stop() {
    engine_.stop_streams(absl::UnavailableError("the server is shutting down"));
    engine_.refiner.stop();
    engine_.rank_jobs.stop();
    engine_.views.stop();
    engine_.preprocessing.stop();
    engine_.cache->stop();
  }

  std::shared_ptr<const Session> open() {
    const std::string off = curvecast::testing::to_off(curvecast::testing::icosphere(3));
    MeshUpload upload(engine_.meshes);
    EXPECT_TRUE(upload.begin("ball.off", off.size(), "").ok());
    EXPECT_TRUE(upload.append(off).ok());
    Waiter waiter;
    EXPECT_TRUE(engine_.sessions.join({upload.finish().value(), {}}, {.points = kMadeFor}, &waiter).ok());
    return waiter.wait().value();
  }

  /// Starts clients that ask for far more points than the curve is made for, and returns once each has a frame. They take frames
  /// as long as `wants_more` of the last one says so; then their conversations end with `end`.
  std::vector<std::jthread> start_crowd(const std::string& session_id,
                                        bool (*wants_more)(const std::optional<v1::PointFrame>& frame), absl::StatusCode end) {
    const auto first_frames = std::make_shared<std::latch>(kClients);
    std::vector<std::jthread> crowd;
    for (int c = 0; c < kClients; ++c) {
      crowd.emplace_back([this, session_id, wants_more, end, first_frames] {
        Client client(engine_, session_id);
        client.look(100'000);
        std::optional<v1::PointFrame> frame = client.next();
        first_frames->count_down();
        while (wants_more(frame)) frame = client.next();
        EXPECT_EQ(client.leave().code(), end);
      });
    }
    first_frames->wait();
    return crowd;
  }

  testing::TemporaryFolder folder_;
  std::shared_ptr<spdlog::logger> log_ = make_logger(false, false);
  Engine engine_{ServerOptions{.threads = 2}, log_, SessionCache::open(folder_.path(), std::uint64_t{1} << 30, log_).value()};
};

/// What a thread has seen. Each keeps its own: a shared one, with its lock, would order the threads for ThreadSanitizer.
class Seen {
 public:
  void curve(const SurfaceCurve& curve) {
    const std::vector<float> z(curve.z.begin(), curve.z.end());
    EXPECT_EQ(heights_.try_emplace(curve.revision, z).first->second, z) << "revision " << curve.revision;
  }
  void frame(std::uint64_t points, const v1::PointFrame& frame) {
    EXPECT_EQ(count_points(frame), points);
    const std::string bytes = point_bytes(frame);
    EXPECT_EQ(frames_.try_emplace({frame.curve_revision(), points}, bytes).first->second, bytes);
  }
  void add(const Seen& other) {
    for (const auto& [revision, z] : other.heights_) {
      EXPECT_EQ(heights_.try_emplace(revision, z).first->second, z) << "revision " << revision;
    }
    for (const auto& [key, bytes] : other.frames_) {
      EXPECT_EQ(frames_.try_emplace(key, bytes).first->second, bytes) << "revision " << key.first;
    }
  }

 private:
  std::map<std::uint64_t, std::vector<float>> heights_;                    // by revision
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> frames_;  // by revision and number of points
};

TEST_F(EngineTest, ViewsShareWhatNoCameraChanges) {
  const std::shared_ptr<const Session> session = open();
  PointSetRequest request;
  std::string first;
  std::size_t bytes = 0;
  for (const double distance : {3.0, 3.0, 5.0, 3.0}) {
    request.options.points = 100;
    request.options.density = curvecast::testing::seen_from(Vec3d(0, 0, distance), {CurvatureTerm{}, ViewTerm{}});
    const absl::StatusOr<Answer> frame = make_frame(*session, {.point_set = request}, engine_.view_cache, {});
    ASSERT_TRUE(frame.ok()) << frame.status();
    EXPECT_EQ(count_points(frame->frame), 100u);
    if (bytes == 0) {
      bytes = engine_.view_cache.fixed_densities.byte_size();
      first = point_bytes(frame->frame);
    }
    EXPECT_GT(bytes, session->curve()->size() * sizeof(float));
    EXPECT_EQ(engine_.view_cache.fixed_densities.byte_size(), bytes) << "made once for all";
    EXPECT_EQ(point_bytes(frame->frame) == first, distance == 3.0);
  }
  EXPECT_EQ(engine_.view_cache.workspaces.idle(), 1u);
}

TEST_F(EngineTest, EveryReaderSeesWholeRevisions) {
  const std::shared_ptr<const Session> session = open();
  std::atomic<bool> done = false;
  std::array<Seen, kClients> clients;
  Seen observer, loader;
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t c = 0; c < kClients; ++c) {
      threads.emplace_back([&, c] {
        Client client(engine_, session->id);
        std::uint64_t last_revision = 0;
        // Far more than any client can have asked for before: each round makes a revision.
        for (std::uint64_t points = 1000 + c % 2; points < 20'000; points *= 4) {
          client.look(points);
          bool is_coarse = true;
          while (is_coarse) {
            const std::optional<v1::PointFrame> frame = client.next();
            ASSERT_TRUE(frame);
            EXPECT_GE(frame->curve_revision(), last_revision);
            last_revision = frame->curve_revision();
            clients[c].frame(points, *frame);
            is_coarse = frame->statistics().refining();
          }
        }
        EXPECT_TRUE(client.leave().ok());
      });
    }
    std::jthread observing([&] {
      while (!done.load(std::memory_order_relaxed)) {
        observer.curve(*session->curve());
        std::this_thread::sleep_for(kPause);
      }
    });
    std::jthread loading([&] {
      while (!done.load(std::memory_order_relaxed)) {
        const auto loaded = engine_.cache->load(session->id);
        if (loaded.ok()) loader.curve(*(*loaded)->curve());
        std::this_thread::sleep_for(kPause);
      }
    });
    threads.clear();
    done = true;
  }
  EXPECT_GT(session->curve()->revision, 2u);
  stop();
  // The newest one has survived.
  const auto loaded = engine_.cache->load(session->id);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ((*loaded)->curve()->revision, session->curve()->revision);
  Seen all;
  all.curve(*session->curve());
  all.curve(*(*loaded)->curve());
  for (const Seen& client : clients) all.add(client);
  all.add(observer);
  all.add(loader);
}

TEST_F(EngineTest, ClosesInTheMidstOfRefinement) {
  const std::shared_ptr<const Session> session = open();
  {
    // Closed or not, the promise of a last frame is kept.
    const auto is_coarse = [](const std::optional<v1::PointFrame>& frame) {
      EXPECT_TRUE(frame);
      return frame && frame->statistics().refining();
    };
    const std::vector<std::jthread> crowd = start_crowd(session->id, is_coarse, absl::StatusCode::kOk);
    EXPECT_TRUE(engine_.close_session(session->id, "").ok());
    const std::shared_ptr<const Session> again = open();  // the same mesh once more, beside those that still have the old one
    EXPECT_EQ(again->id, session->id);
    EXPECT_NE(again->revisions, session->revisions);
    EXPECT_EQ(again->curve()->revision, 1u);
  }
  EXPECT_FALSE(session->revisions->refining());
}

TEST_F(EngineTest, ABetterFrameComesOnceTheServerHasTimeForIt) {
  const std::shared_ptr<const Session> session = open();
  Client client(engine_, session->id);
  client.look(100'000);
  std::optional<v1::PointFrame> frame = client.next();
  constexpr std::int64_t kFar = std::int64_t{1} << 50;
  engine_.queued.add("other", kFar);  // too busy for any frame
  EXPECT_TRUE(eventually([&] { return !session->revisions->refining(); }));
  engine_.refiner.stop();  // it has told the conversation
  engine_.queued.add("other", -kFar);
  // The client says nothing more.
  while (frame && frame->statistics().refining()) frame = client.next();
  EXPECT_TRUE(frame);
  EXPECT_TRUE(client.leave().ok());
}

TEST_F(EngineTest, WhatWasClosedIsNotSavedAnyMore) {
  const std::shared_ptr<const Session> session = open();
  const auto finer = std::make_shared<SurfaceCurve>(*session->curve());
  finer->revision = 7;
  session->revisions->publish(finer);
  EXPECT_TRUE(engine_.close_session(session->id, "").ok());
  engine_.sessions.save(*session);
  EXPECT_FALSE(engine_.sessions.must_load(session->id));
  open();
  engine_.sessions.save(*session);  // another one by the same name
  stop();
  EXPECT_EQ(engine_.cache->load(session->id).value()->curve()->revision, 1u);
}

TEST_F(EngineTest, StopsInTheMidstOfRefinement) {
  const std::shared_ptr<const Session> session = open();
  std::vector<std::jthread> crowd = start_crowd(
      session->id, [](const std::optional<v1::PointFrame>& frame) { return frame.has_value(); }, absl::StatusCode::kUnavailable);
  stop();
  crowd.clear();
  EXPECT_FALSE(session->revisions->refining());
}

}  // namespace
}  // namespace curvecast::server
