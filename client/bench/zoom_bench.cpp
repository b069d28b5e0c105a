#include "client/bench/zoom_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "client/bench/scene/stop_picture.h"
#include "client/bench/scene/zoom_path.h"
#include "client/bench/server/server_stage.h"
#include "client/cli/report.h"
#include "core/base/random.h"
#include "core/mesh/repair.h"
#include "core/mesh_io/mesh_io.h"

namespace curvecast::cli::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::minutes kPatience{10};  // for one frame
constexpr double kFarthest = 1.25;             // diagonals: from there the whole mesh is seen
constexpr double kTurns = 3;                   // about the line of sight, on the way down and again on the way up
constexpr double kKibi = 1024, kMebi = 1 << 20;
constexpr double kWanderNear = 0.001, kWanderFar = 0.02;  // diagonals

double milliseconds(Clock::duration time) { return std::chrono::duration<double, std::milli>(time).count(); }

double mebibytes(std::uint64_t bytes) { return static_cast<double>(bytes) / kMebi; }

v1::Viewport viewport_of(const ZoomBenchOptions& options) {
  v1::Viewport viewport;
  viewport.set_width(static_cast<std::uint32_t>(options.width));
  viewport.set_height(static_cast<std::uint32_t>(options.height));
  return viewport;
}

/// What came of the views up to a stop, and of the stop.
struct Leg {
  double key_bytes = 0, delta_bytes = 0;
  std::uint64_t frames = 0;
  double settle_ms = 0;  // from the last view to its last frame
  client::Frame last;    // of the stop
};

/// What came of all views in motion.
struct Motion {
  std::vector<double> delta_ms, key_ms;                          // from sending a view to its first frame, decoded
  std::vector<double> select_ms, encode_ms, decode_ms, changed;  // of the deltas: what takes it, and points that come or go
  std::uint64_t views = 0, frames = 0;
  double server_cpu = 0;  // ms
};

/// One client on its way.
class Traveller {
 public:
  static absl::StatusOr<Traveller> begin(const MeshFile& file, std::uint64_t points, const ZoomBenchOptions& options,
                                         const ExecutionContext& context) {
    absl::StatusOr<ServerStage> stage =
        ServerStage::open(file, *std::ranges::max_element(options.points), options.command, context);
    if (!stage.ok()) return stage.status();
    return Traveller(*std::move(stage), points, options);
  }

  double size() const { return stage_.box().diagonal(); }
  const ServerProcess& server() const { return stage_.server(); }
  const Motion& motion() const { return motion_; }

  /// Bytes of the session beyond what it had at first: of its ranked candidates, as long as no curve is refined.
  absl::StatusOr<std::uint64_t> session_bytes() {
    const absl::StatusOr<v1::Session> session = client::Client(connection_).get_session(stage_.session_id());
    if (!session.ok()) return session.status();
    return session->memory_bytes();
  }

  v1::SampleRequest view(const v1::Camera& camera) const {
    v1::SampleRequest sample;
    sample.set_points(points_);
    sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
    sample.add_density()->mutable_screen();
    sample.add_density()->mutable_frustum();
    *sample.add_cameras() = camera;
    *sample.mutable_viewport() = viewport_;
    return sample;
  }

  /// Sends views at the rate, whatever comes back, and waits for the last frame of the last of them.
  absl::StatusOr<Leg> travel(const std::vector<v1::Camera>& cameras, const ExecutionContext& context) {
    Leg leg;
    const double cpu_before = server().cpu_milliseconds();
    const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate_));
    std::vector<Clock::time_point> sent;  // by number, from `first` on
    std::vector<bool> answered(cameras.size());
    const std::uint64_t first = next_;
    Clock::time_point due = Clock::now();
    while (true) {
      if (absl::Status status = context.check(); !status.ok()) return status;
      if (sent.size() < cameras.size() && Clock::now() >= due) {
        const v1::SampleRequest sample = view(cameras[sent.size()]);
        sent.push_back(Clock::now());
        if (const auto sequence = stream_->send_view(sample, false, next_++); !sequence.ok()) return sequence.status();
        due += period;
        if (sent.size() == cameras.size()) motion_.server_cpu += server().cpu_milliseconds() - cpu_before;
      }
      const bool is_waiting = sent.size() == cameras.size();
      const Clock::duration wait =
          is_waiting ? Clock::duration(kPatience) : std::max(due - Clock::now(), Clock::duration::zero());
      absl::StatusOr<client::Frame> frame = stream_->next_frame(std::chrono::ceil<std::chrono::milliseconds>(wait));
      if (absl::IsDeadlineExceeded(frame.status()) && !is_waiting) continue;
      if (!frame.ok()) return frame.status();
      if (frame->sequence < first) continue;
      const std::size_t number = frame->sequence - first;
      count(*frame, Clock::now() - sent[number], !answered[number], leg);
      answered[number] = true;
      const bool is_last = is_waiting && number + 1 == cameras.size() && !frame->statistics.refining();
      if (!is_last) continue;
      leg.settle_ms = milliseconds(Clock::now() - sent.back());
      leg.last = *std::move(frame);
      motion_.views += cameras.size();
      return leg;
    }
  }

 private:
  Traveller(ServerStage stage, std::uint64_t points, const ZoomBenchOptions& options)
      : stage_(std::move(stage)),
        points_(points),
        rate_(options.rate),
        viewport_(viewport_of(options)),
        connection_(stage_.connect()),
        stream_(client::ViewStream::open(*connection_, stage_.session_id())) {}

  void count(const client::Frame& frame, Clock::duration since, bool is_first, Leg& leg) {
    ++leg.frames;
    ++motion_.frames;
    (frame.is_delta ? leg.delta_bytes : leg.key_bytes) += static_cast<double>(frame.encoded_bytes);
    if (!is_first || !frame.error.ok()) return;
    (frame.is_delta ? motion_.delta_ms : motion_.key_ms).push_back(milliseconds(since));
    if (!frame.is_delta) return;
    const v1::FrameStatistics& s = frame.statistics;
    motion_.select_ms.push_back(1e3 * (s.density_seconds() + s.equalise_seconds()));
    motion_.encode_ms.push_back(1e3 * s.encode_seconds());
    motion_.decode_ms.push_back(1e3 * frame.decode_seconds);
    motion_.changed.push_back(static_cast<double>(frame.added + frame.removed));
  }

  ServerStage stage_;
  std::uint64_t points_;
  double rate_;
  v1::Viewport viewport_;
  std::shared_ptr<client::Connection> connection_;
  std::unique_ptr<client::ViewStream> stream_;
  std::uint64_t next_ = 1;
  Motion motion_;
};

BenchTable stops_table(std::uint64_t points) {
  return {absl::StrFormat("stops, N = %d", points),
          {"way", "distance/size", "points", "wanted", "limit", "settled ms", "key KiB", "delta KiB", "frames", "ranks MiB",
           "coverage %"},
          {}};
}

/// Goes down to the surface and back up.
absl::Status go(Traveller& traveller, const TriangleMesh& mesh, std::uint64_t points, const ZoomBenchOptions& options,
                const ExecutionContext& context, BenchReport& report) {
  const SurfacePlace place = front_of(mesh);
  const absl::StatusOr<std::uint64_t> first_bytes = traveller.session_bytes();
  if (!first_bytes.ok()) return first_bytes.status();
  const int legs = 2 * options.stops, views = std::max(1, options.frames / legs);
  BenchTable table = stops_table(points);
  for (int leg = 0; leg < legs; ++leg) {
    // From 0, far away, to 1, the nearest, and on to 2, far away again.
    const auto distance_at = [&](double t) { return kFarthest * std::pow(options.nearest / kFarthest, t < 1 ? t : 2 - t); };
    const auto camera_at = [&](double t) { return camera_above(place, distance_at(t) * traveller.size(), 360 * kTurns * t); };
    std::vector<v1::Camera> cameras;
    for (int v = 1; v <= views; ++v) {
      cameras.push_back(camera_at((leg + static_cast<double>(v) / views) / options.stops));
    }
    if (leg == 0) cameras.insert(cameras.begin(), camera_at(0));
    context.progress(absl::StrFormat("zoom, N = %d", points), static_cast<double>(leg) / legs);
    const absl::StatusOr<Leg> made = traveller.travel(cameras, context);
    if (!made.ok()) return made.status();
    const absl::StatusOr<std::uint64_t> bytes = traveller.session_bytes();
    if (!bytes.ok()) return bytes.status();
    const client::Frame& frame = made->last;
    const client::Points nothing;
    const client::Points& shown = frame.error.ok() ? *frame.points : nothing;
    std::optional<double> coverage;
    const bool is_down = leg < options.stops;
    if (!options.pictures.empty()) {
      const std::string name = absl::StrFormat("%d_%02d_%s.png", points, leg + 1, is_down ? "down" : "up");
      const absl::StatusOr<double> drawn =
          draw_stop(shown, mesh, cameras.back(), viewport_of(options), (std::filesystem::path(options.pictures) / name).string());
      if (!drawn.ok()) return drawn.status();
      coverage = 100 * *drawn;
    }
    const double distance = distance_at(static_cast<double>(leg + 1) / options.stops);
    table.rows.push_back({is_down ? "down" : "up", distance, shown.size(), points,
                          frame.error.ok() ? point_limit_name(frame.statistics.limit()) : "nothing to see", made->settle_ms,
                          made->key_bytes / kKibi, made->delta_bytes / kKibi, made->frames,
                          mebibytes(*bytes - std::min(*bytes, *first_bytes)), coverage ? Json(*coverage) : Json()});
  }
  report.tables.push_back(std::move(table));
  return absl::OkStatus();
}

/// Looks at random places from near by, one after the other, as soon as each has its last frame.
absl::Status wander(Traveller& traveller, const TriangleMesh& mesh, const ZoomBenchOptions& options,
                    const ExecutionContext& context) {
  for (int i = 0; i < options.wander; ++i) {
    context.progress("wandering", static_cast<double>(i) / options.wander);
    const auto seed = static_cast<std::uint64_t>(i);
    const double distance = kWanderNear * std::pow(kWanderFar / kWanderNear, random_unit(seed, 3)) * traveller.size();
    const auto made = traveller.travel({camera_above(random_place(mesh, seed), distance, 360 * random_unit(seed, 4))}, context);
    if (!made.ok()) return made.status();
  }
  return absl::OkStatus();
}

absl::Status zoom(const MeshFile& file, const TriangleMesh& mesh, std::uint64_t points, const ZoomBenchOptions& options,
                  const ExecutionContext& context, BenchReport& report) {
  absl::StatusOr<Traveller> traveller = Traveller::begin(file, points, options, context);
  if (!traveller.ok()) return traveller.status();
  const std::string name = absl::StrFormat("N = %d", points);
  const auto add = [&](const char* what, double value, const char* unit) {
    report.results.push_back({absl::StrCat(name, ": ", what), value, unit});
  };
  const double start = mebibytes(traveller->server().resident_bytes());
  if (absl::Status status = go(*traveller, mesh, points, options, context, report); !status.ok()) return status;
  const Motion motion = traveller->motion();
  const double end = mebibytes(traveller->server().resident_bytes()), peak = mebibytes(traveller->server().peak_bytes());
  add("latency of deltas p50", quantile(motion.delta_ms, 0.5), "ms");
  add("latency of deltas p99", quantile(motion.delta_ms, 0.99), "ms");
  add("of it selecting p50", quantile(motion.select_ms, 0.5), "ms");
  add("of it encoding p50", quantile(motion.encode_ms, 0.5), "ms");
  add("of it decoding p50", quantile(motion.decode_ms, 0.5), "ms");
  add("points that come or go with a delta p50", quantile(motion.changed, 0.5), "");
  add("latency of key frames p50", quantile(motion.key_ms, 0.5), "ms");
  add("latency of key frames p99", quantile(motion.key_ms, 0.99), "ms");
  const auto answered = static_cast<double>(motion.delta_ms.size() + motion.key_ms.size());
  add("views", static_cast<double>(motion.views), "");
  add("views overtaken", 100 * (1 - answered / static_cast<double>(motion.views)), "%");
  add("processor time of a frame in motion, server", motion.server_cpu / std::max(1.0, static_cast<double>(motion.frames)), "ms");
  add("memory of the server, at first", start, "MiB");
  add("memory of the server, at most", peak, "MiB");
  add("memory of the server, in the end", end, "MiB");
  if (options.wander > 0) {
    if (absl::Status status = wander(*traveller, mesh, options, context); !status.ok()) return status;
    const std::string what = absl::StrFormat("memory of the server after %d views of random places", options.wander);
    add(what.c_str(), mebibytes(traveller->server().resident_bytes()), "MiB");
    add("memory of the server, at most, with them", mebibytes(traveller->server().peak_bytes()), "MiB");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<BenchReport> bench_zoom(const MeshFile& file, const ZoomBenchOptions& options, const ExecutionContext& context) {
  if (options.points.empty() || options.stops < 1 || options.frames < 1 || !(options.rate > 0) || !(options.nearest > 0) ||
      options.nearest >= kFarthest || options.width < 1 || options.height < 1 || options.wander < 0) {
    return absl::InvalidArgumentError(
        "a zoom needs points, stops and frames, a rate, a picture, and a place that is nearer than its start");
  }
  if (!options.pictures.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.pictures, error);
    if (error) return absl::FailedPreconditionError(absl::StrCat(options.pictures, ": cannot be made: ", error.message()));
  }
  absl::StatusOr<PolygonSoup> soup = read_mesh(file, context);
  if (!soup.ok()) return soup.status();
  const absl::StatusOr<RepairedMesh> repaired = repair(*std::move(soup), context);
  if (!repaired.ok()) return repaired.status();
  BenchReport report{.name = "zoom", .results = {}};
  for (const std::uint64_t points : options.points) {
    if (absl::Status status = zoom(file, repaired->mesh, points, options, context, report); !status.ok()) return status;
  }
  report.notes = {
      absl::StrFormat("A camera of 45 degrees, %d x %d pixels, goes down to the surface and back by equal factors, %g views a "
                      "second, and waits at each stop until nothing better follows. The server has a process of its own; they "
                      "talk over TCP on the loopback.",
                      options.width, options.height, options.rate),
      "settled: from the stop's view to its last frame. key, delta, frames: since the stop before. ranks: what the session's "
      "memory has grown by since the first view. coverage: the part of the mesh's outline that the points cover. Latency: from "
      "sending a view until its first frame is decoded. Processor time: of all of the server, ranks that are made included."};
  return report;
}

}  // namespace curvecast::cli::bench
