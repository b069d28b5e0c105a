#include "server/engine/metrics.h"

#include <absl/status/status.h>
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <chrono>
#include <vector>

#include "core/base/mutex.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/base/build_info.h"
#include "server/base/process_usage.h"

namespace curvecast::server {
namespace {

using prometheus::Counter;
using prometheus::Family;
using prometheus::Gauge;
using prometheus::Histogram;
using prometheus::Registry;

const std::vector<double> kRequestSeconds = {0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 300};
const std::vector<double> kStageSeconds = {0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01,
                                           0.025,  0.05,    0.1,    0.25,  0.5,    1,     5};

Family<Counter>& counters(Registry& registry, const std::string& name, const std::string& help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

Family<Gauge>& gauges(Registry& registry, const std::string& name, const std::string& help) {
  return prometheus::BuildGauge().Name(name).Help(help).Register(registry);
}

Family<Histogram>& histograms(Registry& registry, const std::string& name, const std::string& help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

double now() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

}  // namespace

struct Metrics::Families {
  /// Frames of one kind.
  struct Frames {
    Counter &count, &bytes, &points;
  };

  Registry registry;
  Family<Counter>& requests = counters(registry, "curvecast_requests_total", "Requests that are over, by gRPC status code.");
  Family<Histogram>& request_seconds = histograms(registry, "curvecast_request_seconds",
                                                  "From the start of a request to its end; of StreamViews, the conversation.");

  Counter& unauthenticated =
      counters(registry, "curvecast_unauthenticated_total", "Calls and WebSockets refused for want of a token that is known.")
          .Add({});

  Gauge& open_streams = gauges(registry, "curvecast_open_streams", "Conversations of views and frames.").Add({});
  Counter& views_received = counters(registry, "curvecast_views_received_total", "Views that streams have brought.").Add({});
  Counter& views_answered =
      counters(registry, "curvecast_views_answered_total", "Views to which a first frame was sent, be it an error.").Add({});
  Counter& views_overtaken =
      counters(registry, "curvecast_views_overtaken_total", "Views never answered: a newer one or the stream's end came first.")
          .Add({});

  Family<Counter>& frames = counters(registry, "curvecast_frames_total", "Frames sent.");
  Counter& frames_shared = counters(registry, "curvecast_frames_shared_total", "Frames that had been made for others.").Add({});
  Family<Counter>& frame_bytes = counters(registry, "curvecast_frame_bytes_total", "Bytes of the frames sent, as messages.");
  Family<Counter>& frame_points = counters(registry, "curvecast_frame_points_total", "Points that the frames sent carry.");
  Frames key = of_kind("key"), delta = of_kind("delta"), error = of_kind("error");

  Family<Histogram>& stage_seconds =
      histograms(registry, "curvecast_stage_seconds", "Of one answer to a view or of a point set.");
  Histogram& density = stage_seconds.Add({{"stage", "density"}}, kStageSeconds);
  Histogram& equalise = stage_seconds.Add({{"stage", "equalise"}}, kStageSeconds);
  Histogram& encode = stage_seconds.Add({{"stage", "encode"}}, kStageSeconds);

  Histogram& view_wait =
      histograms(registry, "curvecast_view_wait_seconds", "How long views waited for a worker.").Add({}, kStageSeconds);
  Histogram& view_seconds =
      histograms(registry, "curvecast_view_seconds", "From when a view wanted a worker until the worker was done with it.")
          .Add({}, kStageSeconds);
  Counter& view_busy =
      counters(registry, "curvecast_view_worker_busy_seconds_total", "What the workers for views have been at work.").Add({});
  Family<Histogram>& preprocess_seconds =
      histograms(registry, "curvecast_preprocess_seconds", "Of one session, by status code; without its wait.");
  Counter& stalls =
      counters(registry, "curvecast_stalled_calls_total", "Calls ended because their client did not read what was sent.").Add({});

  Family<Counter>& store_operations =
      counters(registry, "curvecast_store_operations_total", "Calls of the store that servers share, by how they ended.");
  Family<Histogram>& store_seconds = histograms(registry, "curvecast_store_seconds", "Of one call of the store.");

  Family<Counter>& refinements = counters(registry, "curvecast_refinements_total", "Refinements of curves that are over.");
  Counter& finer = refinements.Add({{"result", "finer"}});
  Counter& unchanged = refinements.Add({{"result", "unchanged"}});

  Frames of_kind(const char* kind) {
    const prometheus::Labels labels = {{"kind", kind}};
    return {frames.Add(labels), frame_bytes.Add(labels), frame_points.Add(labels)};
  }

  // What follows is set and read together.
  Mutex mutex;
  Gauge& connections ABSL_GUARDED_BY(mutex) = gauges(registry, "curvecast_connections", "Connections of the gRPC port.").Add({});
  Counter& ended_connections ABSL_GUARDED_BY(mutex) =
      counters(registry, "curvecast_connections_ended_total", "Connections without a call that gave way to newer ones.").Add({});
  Counter& refused_connections ABSL_GUARDED_BY(mutex) =
      counters(registry, "curvecast_connections_refused_total", "Connections for which there was no room.").Add({});
  Gauge& worker_threads ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_threads", "Cores that the server's work is meant for.").Add({});
  Family<Gauge>& waiting ABSL_GUARDED_BY(mutex) = gauges(registry, "curvecast_queue_depth", "Jobs that wait for a worker.");
  Gauge& waiting_views ABSL_GUARDED_BY(mutex) = waiting.Add({{"queue", "views"}});
  Gauge& waiting_calls ABSL_GUARDED_BY(mutex) = waiting.Add({{"queue", "calls"}});
  Gauge& waiting_chunks ABSL_GUARDED_BY(mutex) = waiting.Add({{"queue", "chunks"}});
  Gauge& waiting_preprocessing ABSL_GUARDED_BY(mutex) = waiting.Add({{"queue", "preprocessing"}});
  Family<Gauge>& overdue ABSL_GUARDED_BY(mutex) = gauges(registry, "curvecast_jobs_overdue",
                                                         "Jobs that take far longer than expected, and may be stuck.");
  Gauge& overdue_views ABSL_GUARDED_BY(mutex) = overdue.Add({{"queue", "views"}});
  Gauge& overdue_calls ABSL_GUARDED_BY(mutex) = overdue.Add({{"queue", "calls"}});
  Gauge& overdue_chunks ABSL_GUARDED_BY(mutex) = overdue.Add({{"queue", "chunks"}});
  Gauge& overdue_preprocessing ABSL_GUARDED_BY(mutex) = overdue.Add({{"queue", "preprocessing"}});
  Gauge& sessions ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_sessions", "Sessions in memory, those being made too.").Add({});
  Gauge& session_bytes ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_session_bytes", "Of their curves and ranked candidates.").Add({});
  Gauge& meshes ABSL_GUARDED_BY(mutex) = gauges(registry, "curvecast_meshes", "Mesh files held.").Add({});
  Gauge& mesh_bytes ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_mesh_bytes", "Of mesh files held and being received.").Add({});
  Gauge& cache_bytes ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_cache_bytes", "Of the files in the cache's folder.").Add({});
  Gauge& queued_bytes ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_queued_bytes", "Of answers that wait until clients read them.").Add({});
  Gauge& memory_bytes ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_memory_budget_bytes", "That all work may take, in memory and in a file instead.").Add({});
  Gauge& held_bytes ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_memory_held_bytes", "Of sessions and of answers that wait.").Add({});
  Gauge& reserved_bytes ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_memory_reserved_bytes", "That running jobs have asked for.").Add({});
  Family<Counter>& evicted ABSL_GUARDED_BY(mutex) = counters(
      registry, "curvecast_evicted_total", "Sessions that left the memory, and meshes that went, to make room for others.");
  Family<Counter>& refused ABSL_GUARDED_BY(mutex) =
      counters(registry, "curvecast_refused_total", "Streams, views, calls and uploads refused, by the limit that they met.");
  Gauge& unsaved_sessions ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_unsaved_sessions", "Sessions that wait to be written to the cache.").Add({});
  Gauge& unstored ABSL_GUARDED_BY(mutex) =
      gauges(registry, "curvecast_unstored", "Sessions that wait to be put into the store that servers share.").Add({});
  Family<Counter>& cache_operations ABSL_GUARDED_BY(mutex) =
      counters(registry, "curvecast_cache_operations_total", "Sessions loaded, saved and removed, and tries that failed.");
  Gauge& resident ABSL_GUARDED_BY(mutex) =
      gauges(registry, "process_resident_memory_bytes", "Resident memory size in bytes.").Add({});
  Gauge& open_files ABSL_GUARDED_BY(mutex) = gauges(registry, "process_open_fds", "Number of open file descriptors.").Add({});
  Gauge& threads ABSL_GUARDED_BY(mutex) = gauges(registry, "process_threads", "Number of threads.").Add({});
  Counter& cpu ABSL_GUARDED_BY(mutex) =
      counters(registry, "process_cpu_seconds_total", "Total user and system CPU time spent in seconds.").Add({});
};

Metrics::Metrics() : families_(std::make_unique<Families>()) {
  Registry& registry = families_->registry;
  const BuildInfo build = build_info();
  gauges(registry, "curvecast_build_info", "Always 1; the labels tell.")
      .Add({{"version", build.version}, {"compiler", build.compiler}, {"build_type", build.type}})
      .Set(1);
  gauges(registry, "curvecast_start_time_seconds", "When the server was started, since the epoch.").Add({}).Set(now());
}

Metrics::~Metrics() = default;

void Metrics::request(std::string_view method, int code, double seconds) {
  const std::string name(method);
  families_->requests.Add({{"method", name}, {"code", absl::StatusCodeToString(static_cast<absl::StatusCode>(code))}})
      .Increment();
  if (static_cast<absl::StatusCode>(code) == absl::StatusCode::kUnauthenticated) unauthenticated();
  families_->request_seconds.Add({{"method", name}}, kRequestSeconds).Observe(seconds);
}

void Metrics::unauthenticated() { families_->unauthenticated.Increment(); }
void Metrics::stream_opened() { families_->open_streams.Increment(); }
void Metrics::stream_closed() { families_->open_streams.Decrement(); }
void Metrics::view_received() { families_->views_received.Increment(); }
void Metrics::view_answered() { families_->views_answered.Increment(); }
void Metrics::views_overtaken(std::size_t count) { families_->views_overtaken.Increment(static_cast<double>(count)); }

void Metrics::frame(const v1::PointFrame& frame) {
  const bool is_delta = frame.kind() == v1::FRAME_KIND_DELTA;
  Families::Frames& kind = frame.has_error() ? families_->error : is_delta ? families_->delta : families_->key;
  kind.count.Increment();
  kind.bytes.Increment(static_cast<double>(frame.ByteSizeLong()));
  std::uint64_t points = 0;
  for (const v1::PointBlock& block : frame.points()) points += block.count();
  kind.points.Increment(static_cast<double>(points));
  if (!frame.has_error()) stages(frame.statistics());
}

void Metrics::stages(const v1::FrameStatistics& statistics) {
  families_->density.Observe(statistics.density_seconds());
  families_->equalise.Observe(statistics.equalise_seconds());
  families_->encode.Observe(statistics.encode_seconds());
}

void Metrics::refinement(bool is_finer) { (is_finer ? families_->finer : families_->unchanged).Increment(); }

void Metrics::view_job(double waited_seconds, double busy_seconds) {
  families_->view_wait.Observe(waited_seconds);
  families_->view_seconds.Observe(waited_seconds + busy_seconds);
  families_->view_busy.Increment(busy_seconds);
}

void Metrics::preprocessing(int code, double seconds) {
  const std::string name = absl::StatusCodeToString(static_cast<absl::StatusCode>(code));
  families_->preprocess_seconds.Add({{"code", name}}, kRequestSeconds).Observe(seconds);
}

void Metrics::store_call(std::string_view operation, std::string_view result, double seconds) {
  const std::string name(operation);
  families_->store_operations.Add({{"operation", name}, {"result", "error"}});  // so that its first one is an increase
  families_->store_operations.Add({{"operation", name}, {"result", std::string(result)}}).Increment();
  families_->store_seconds.Add({{"operation", name}}, kRequestSeconds).Observe(seconds);
}

void Metrics::stalled(std::size_t count) { families_->stalls.Increment(static_cast<double>(count)); }

std::string Metrics::text(const Gauges& values) {
  Families& f = *families_;
  const MutexLock lock(f.mutex);
  f.connections.Set(static_cast<double>(values.connections));
  f.worker_threads.Set(values.threads);
  f.waiting_views.Set(static_cast<double>(values.waiting_views));
  f.waiting_calls.Set(static_cast<double>(values.waiting_calls));
  f.waiting_chunks.Set(static_cast<double>(values.waiting_chunks));
  f.waiting_preprocessing.Set(static_cast<double>(values.waiting_preprocessing));
  f.sessions.Set(static_cast<double>(values.sessions));
  f.session_bytes.Set(static_cast<double>(values.session_bytes));
  f.meshes.Set(static_cast<double>(values.meshes));
  f.mesh_bytes.Set(static_cast<double>(values.mesh_bytes));
  f.cache_bytes.Set(static_cast<double>(values.cache_bytes));
  f.overdue_views.Set(static_cast<double>(values.overdue_views));
  f.overdue_calls.Set(static_cast<double>(values.overdue_calls));
  f.overdue_chunks.Set(static_cast<double>(values.overdue_chunks));
  f.overdue_preprocessing.Set(static_cast<double>(values.overdue_preprocessing));
  f.queued_bytes.Set(static_cast<double>(values.queued_bytes));
  f.memory_bytes.Set(static_cast<double>(values.memory_bytes));
  f.held_bytes.Set(static_cast<double>(values.held_bytes));
  f.reserved_bytes.Set(static_cast<double>(values.reserved_bytes));
  const auto count_up = [](Counter& counter, std::uint64_t count) {
    counter.Increment(static_cast<double>(count) - counter.Value());
  };
  count_up(f.frames_shared, values.shared_frames);
  count_up(f.ended_connections, values.ended_connections);
  count_up(f.refused_connections, values.refused_connections);
  for (const auto& [limit, count] : values.refused) count_up(f.refused.Add({{"limit", limit}}), count);
  for (const auto& [what, count] : values.evicted) count_up(f.evicted.Add({{"what", what}}), count);
  f.unsaved_sessions.Set(static_cast<double>(values.unsaved_sessions));
  f.unstored.Set(static_cast<double>(values.unstored));
  for (const auto& [kind, count] : values.cache_operations) {
    count_up(f.cache_operations.Add({{"operation", kind.first}, {"result", kind.second}}), count);
  }
  const ProcessUsage usage = process_usage();
  f.resident.Set(static_cast<double>(usage.resident_bytes));
  f.open_files.Set(static_cast<double>(usage.open_files));
  f.threads.Set(static_cast<double>(usage.threads));
  f.cpu.Increment(usage.cpu_seconds - f.cpu.Value());
  return prometheus::TextSerializer().Serialize(f.registry.Collect());
}

}  // namespace curvecast::server
