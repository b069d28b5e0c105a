// What the server counts, in the text format that Prometheus reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace curvecast::v1 {
class FrameStatistics;
class PointFrame;
}  // namespace curvecast::v1

namespace curvecast::server {

/// What there is at a moment; what has happened so far is counted by Metrics.
struct Gauges {
  std::uint64_t shared_frames = 0;        // so far: frames that had been made for another client
  std::size_t connections = 0;            // of the gRPC port
  std::uint64_t ended_connections = 0;    // so far: that had made no call and gave way to newer ones
  std::uint64_t refused_connections = 0;  // so far: there was no room for them
  int threads = 0;                        // for the server's work
  std::size_t waiting_views = 0;          // jobs that wait for a worker
  std::size_t waiting_calls = 0;          // ... single point sets and inspection
  std::size_t waiting_chunks = 0;         // ... of uploads
  std::size_t waiting_preprocessing = 0;  // ... that take all cores
  std::size_t sessions = 0;               // in memory, those being made too
  std::uint64_t session_bytes = 0;        // of their curves and ranked candidates
  std::size_t meshes = 0;
  std::uint64_t mesh_bytes = 0;  // of uploads under way too
  std::uint64_t cache_bytes = 0;
  // Jobs that take far longer than expected.
  std::size_t overdue_views = 0, overdue_calls = 0, overdue_chunks = 0, overdue_preprocessing = 0;
  std::uint64_t queued_bytes = 0;    // of answers that wait to be read
  std::uint64_t memory_bytes = 0;    // that all work may take, see MemoryBudget
  std::uint64_t held_bytes = 0;      // of it, what sessions and answers take
  std::uint64_t reserved_bytes = 0;  // ... and what running jobs have asked for
  // So far, by the name of the limit: what was refused.
  std::map<std::string, std::uint64_t> refused = {};
  // So far, "sessions" (from memory) and "meshes": what had to make room for others.
  std::map<std::string, std::uint64_t> evicted = {};
  std::size_t unsaved_sessions = 0;  // that wait to be written to the cache
  std::size_t unstored = 0;          // sessions that wait to be put into the store
  // So far, by operation and result: what was done with sessions in the cache.
  std::map<std::pair<std::string, std::string>, std::uint64_t> cache_operations = {};
};

/// Thread-safe. Counting a frame or a view takes an atomic addition; a duration takes its histogram's own lock for as long as it
/// takes to add three numbers.
class Metrics {
 public:
  Metrics();
  ~Metrics();

  /// Counts a request that is over. `code` is a gRPC status code.
  void request(std::string_view method, int code, double seconds);
  /// Counts a WebSocket that was refused for want of a known token; calls are counted by request().
  void unauthenticated();
  void stream_opened();
  void stream_closed();
  void view_received();
  void view_answered();
  /// Counts views that will never be answered.
  void views_overtaken(std::size_t count);
  /// Counts a frame that was handed to the transport.
  void frame(const v1::PointFrame& frame);
  /// Counts how long the stages of an answer took, of a stream or of a single point set.
  void stages(const v1::FrameStatistics& statistics);
  void refinement(bool is_finer);
  /// Counts a job of a view that a worker is done with.
  void view_job(double waited_seconds, double busy_seconds);
  /// Counts a session that was preprocessed, or failed to be. `code` is a canonical status code.
  void preprocessing(int code, double seconds);
  /// Counts a call of the store: see WatchedStore::OnCall.
  void store_call(std::string_view operation, std::string_view result, double seconds);
  /// Counts calls that were ended because their client did not read.
  void stalled(std::size_t count);

  /// Writes all of it, with the process's memory and time, in Prometheus' text format 0.0.4.
  std::string text(const Gauges& values);

 private:
  struct Families;
  const std::unique_ptr<Families> families_;
};

}  // namespace curvecast::server
