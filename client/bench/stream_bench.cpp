#include "client/bench/stream_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "client/bench/abusers.h"
#include "client/bench/server/server_stage.h"
#include "client/cli/report.h"

namespace curvecast::cli::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{60};
constexpr int kWarmUpViews = 120, kViews = 360;
constexpr std::uint64_t kAbused = 8;
constexpr int kAbusedTurns = 3;
constexpr double kKibi = 1024;
constexpr double kGoldenDegrees = 137.50776;  // from client to client
constexpr double kRunDegrees = 0.317;         // from run to run

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Of this process, all threads.
double cpu_milliseconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& time) {
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

/// A session of a mesh, and views of it.
struct Stage : ServerStage {
  explicit Stage(ServerStage stage)
      : ServerStage(std::move(stage)), centre(box().center()), size((box().max - box().min).norm()) {}

  /// On an orbit about the mesh, with silhouettes.
  v1::SampleRequest view(double degrees, std::uint64_t points) const {
    v1::SampleRequest sample;
    sample.set_points(points);
    sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
    sample.add_density()->mutable_view();
    const double angle = degrees * std::numbers::pi / 180;
    v1::Camera& camera = *sample.add_cameras();
    const auto set = [&](v1::Vec3& to, double x, double y, double z) {
      to.set_x(centre.x() + size * x), to.set_y(centre.y() + size * y), to.set_z(centre.z() + size * z);
    };
    set(*camera.mutable_eye(), 2 * std::sin(angle), 0.5, 2 * std::cos(angle));
    set(*camera.mutable_target(), 0, 0, 0);
    return sample;
  }

  Vec3d centre;
  double size;
};

struct Alone {
  std::vector<double> latency, server, decode, bytes, added;  // ms, bytes, points
};

/// One client that waits for each frame.
absl::StatusOr<Alone> stream_alone(const Stage& stage, std::uint64_t points, bool deltas, const ExecutionContext& context) {
  const auto connection = stage.connect();
  const auto stream = client::ViewStream::open(*connection, stage.session_id(), {}, {.deltas = deltas});
  Alone out;
  for (int i = -kWarmUpViews; i < kViews; ++i) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    // The orbit has been gone round before: all candidates that it needs are there.
    const v1::SampleRequest sample = stage.view(i < 0 ? 3 * i : i, points);
    const auto start = Clock::now();
    const absl::StatusOr<client::Frame> frame = answer(*stream, sample, i < 0);
    if (!frame.ok()) return frame.status();
    if (i < 0) continue;
    out.latency.push_back(milliseconds_since(start));
    const v1::FrameStatistics& s = frame->statistics;
    out.server.push_back(1e3 * (s.density_seconds() + s.equalise_seconds() + s.encode_seconds()));
    out.decode.push_back(1e3 * frame->decode_seconds);
    out.bytes.push_back(static_cast<double>(frame->encoded_bytes));
    out.added.push_back(static_cast<double>(frame->added));
  }
  return out;
}

struct Crowd {
  std::vector<double> latency;            // ms, of views that were answered
  double bytes = 0;                       // of all
  double client_cpu = 0, server_cpu = 0;  // ms, of all
  std::uint64_t sent = 0, answered = 0;
};

/// One of many clients: sends views at a fixed rate, whatever comes back; `from`: degrees at which it begins. Its share of the
/// crowd, without the times of processors.
absl::StatusOr<Crowd> join_crowd(const Stage& stage, const StreamBenchOptions& options, double from, std::uint64_t number) {
  const auto connection = stage.connect();
  const auto stream = client::ViewStream::open(*connection, stage.session_id());
  absl::StatusOr<client::Frame> first = answer(*stream, stage.view(from, options.crowd_points), true);
  if (!first.ok()) return first.status();
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / options.rate));
  const auto views = static_cast<std::uint64_t>(options.seconds * options.rate);
  std::vector<Clock::time_point> sent(views + 2);  // by sequence number
  std::vector<bool> answered(views + 2);
  Crowd crowd{.sent = views};
  Clock::time_point next = Clock::now() + period * static_cast<int>(number % 16) / 16;
  std::uint64_t last = 0;
  while (true) {
    if (Clock::now() >= next && last < views) {
      const v1::SampleRequest sample = stage.view(from + static_cast<double>(last + 1), options.crowd_points);
      sent[last + 2] = Clock::now();
      if (const auto sequence = stream->send_view(sample); !sequence.ok()) return sequence.status();
      ++last;
      next += period;
    }
    if (last == views && answered[views + 1]) break;
    const auto wait =
        last == views ? Clock::duration(kPatience) : std::max(Clock::duration(next - Clock::now()), Clock::duration::zero());
    absl::StatusOr<client::Frame> frame = stream->next_frame(std::chrono::ceil<std::chrono::milliseconds>(wait));
    if (absl::IsDeadlineExceeded(frame.status()) && last < views) continue;
    if (!frame.ok()) return frame.status();
    if (!frame->error.ok()) return frame->error;
    crowd.bytes += static_cast<double>(frame->encoded_bytes);
    if (frame->sequence < 2 || answered[frame->sequence]) continue;
    answered[frame->sequence] = true;
    crowd.latency.push_back(milliseconds_since(sent[frame->sequence]));
  }
  crowd.answered = crowd.latency.size();
  return crowd;
}

absl::StatusOr<Crowd> stream_crowd(const Stage& stage, const StreamBenchOptions& options, std::uint64_t clients, int run) {
  std::vector<absl::StatusOr<Crowd>> shares(clients, absl::UnknownError(""));
  const double client_before = cpu_milliseconds(), server_before = stage.server().cpu_milliseconds();
  std::vector<std::jthread> threads;
  for (std::uint64_t c = 0; c < clients; ++c) {
    threads.emplace_back([&, c] {
      // No two look from the same place: their frames would be made once.
      const double from = kGoldenDegrees * static_cast<double>(c) + kRunDegrees * run;
      shares[c] = join_crowd(stage, options, from, c);
    });
  }
  threads.clear();
  Crowd crowd;
  for (const absl::StatusOr<Crowd>& share : shares) {
    if (!share.ok()) return share.status();
    crowd.answered += share->answered;
    crowd.sent += share->sent;
    crowd.bytes += share->bytes;
    crowd.latency.insert(crowd.latency.end(), share->latency.begin(), share->latency.end());
  }
  crowd.client_cpu = cpu_milliseconds() - client_before;
  crowd.server_cpu = stage.server().cpu_milliseconds() - server_before;
  return crowd;
}

/// What clients notice of others that behave badly, and how much memory these cost. In turns without and with them: a 99th
/// percentile needs many views, and machines change their speed.
absl::Status stream_beside_abusers(const Stage& stage, const StreamBenchOptions& options, BenchReport& report) {
  const auto view = [&](double i) { return stage.view(i, options.points); };
  std::vector<double> alone, beside;  // ms
  std::uint64_t before = 0, after = 0;
  const auto add_run = [&](std::vector<double>& latency, int run) {
    const absl::StatusOr<Crowd> crowd = stream_crowd(stage, options, kAbused, run);
    if (crowd.ok()) latency.insert(latency.end(), crowd->latency.begin(), crowd->latency.end());
    return crowd.status();
  };
  for (int turn = 0; turn < kAbusedTurns; ++turn) {
    if (absl::Status status = add_run(alone, 2 * turn); !status.ok()) return status;
    if (turn == 0) before = stage.server().resident_bytes();
    const Abusers abusers(stage.server().address(), stage.session_id(), view);
    if (absl::Status status = add_run(beside, 2 * turn + 1); !status.ok()) return status;
    after = std::max(after, stage.server().resident_bytes());
  }
  const std::string name = absl::StrFormat("%d clients, N = %d, beside clients that behave badly", kAbused, options.crowd_points);
  for (const double q : {0.5, 0.99}) {
    report.results.push_back({absl::StrFormat("%s: latency p%g", name, 100 * q), quantile(beside, q), "ms", quantile(alone, q)});
  }
  report.results.push_back({absl::StrCat(name, ": memory of the server"), static_cast<double>(after) / (1 << 20), "MiB",
                            static_cast<double>(before) / (1 << 20)});
  return absl::OkStatus();
}

/// What the server's memory grows by for each of many clients that have had a frame and ask for nothing more.
absl::StatusOr<double> bytes_of_idle(const Stage& stage, const StreamBenchOptions& options, const ExecutionContext& context) {
  struct Idle {
    std::shared_ptr<client::Connection> connection;
    std::unique_ptr<client::ViewStream> stream;
  };
  std::vector<Idle> clients;
  std::uint64_t before = 0;
  // What the first ones make the server take stays for those after them.
  const std::uint64_t first = options.idle / 10 + 1;
  for (std::uint64_t c = 0; c < first + options.idle; ++c) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    context.progress("idle clients", static_cast<double>(c) / static_cast<double>(first + options.idle));
    if (c == first) before = stage.server().resident_bytes();
    Idle& client = clients.emplace_back();
    client.connection = stage.connect();
    client.stream = client::ViewStream::open(*client.connection, stage.session_id());
    const double degrees = kGoldenDegrees * static_cast<double>(c);
    for (const double further : {0.0, 1.0}) {
      const absl::StatusOr<client::Frame> frame =
          answer(*client.stream, stage.view(degrees + further, options.crowd_points), true);
      if (!frame.ok()) return frame.status();
    }
  }
  const std::uint64_t after = stage.server().resident_bytes();
  return static_cast<double>(after - std::min(before, after)) / static_cast<double>(options.idle);
}

}  // namespace

absl::StatusOr<BenchReport> bench_stream(const MeshFile& file, const StreamBenchOptions& options,
                                         const ExecutionContext& context) {
  absl::StatusOr<ServerStage> opened = ServerStage::open(file, options.points, options.command, context);
  if (!opened.ok()) return opened.status();
  const Stage stage(*std::move(opened));
  BenchReport report{"stream", {}};
  double key_bytes = 0;
  for (const bool deltas : {false, true}) {
    const absl::StatusOr<Alone> alone = stream_alone(stage, options.points, deltas, context);
    if (!alone.ok()) return alone.status();
    const std::string name =
        absl::StrFormat("1 client, N = %d, %s", options.points, deltas ? "deltas by 1 degree" : "key frames");
    const auto add = [&](const char* what, double value, const char* unit) {
      report.results.push_back({absl::StrCat(name, what), value, unit});
    };
    add(": latency p50", quantile(alone->latency, 0.5), "ms");
    add(": latency p99", quantile(alone->latency, 0.99), "ms");
    add(": server p50", quantile(alone->server, 0.5), "ms");
    add(": decoding p50", quantile(alone->decode, 0.5), "ms");
    const double bytes = quantile(alone->bytes, 0.5);
    if (deltas) {
      report.results.push_back({absl::StrCat(name, ": frame"), bytes / kKibi, "KiB", key_bytes / kKibi});
      add(": added", quantile(alone->added, 0.5), "points");
    } else {
      key_bytes = bytes;
      add(": frame", bytes / kKibi, "KiB");
      add(": point", bytes / static_cast<double>(options.points), "B");
    }
  }
  for (std::uint64_t clients = 1; clients <= options.clients; clients *= 8) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    absl::StatusOr<Crowd> crowd = stream_crowd(stage, options, clients, static_cast<int>(2 + clients));
    if (!crowd.ok()) return crowd.status();
    const std::string name = absl::StrFormat("%d clients, N = %d, %g views/s each", clients, options.crowd_points, options.rate);
    const auto add = [&](const char* what, double value, const char* unit) {
      report.results.push_back({absl::StrCat(name, what), value, unit});
    };
    const auto answered = static_cast<double>(crowd->answered);
    add(": latency p50", quantile(crowd->latency, 0.5), "ms");
    add(": latency p99", quantile(crowd->latency, 0.99), "ms");
    add(": overtaken", 100 * (1 - answered / static_cast<double>(crowd->sent)), "%");
    add(": frame, mean", crowd->bytes / answered / kKibi, "KiB");
    add(": processor time of a frame, server", crowd->server_cpu / answered, "ms");
    add(": processor time of a frame, client", crowd->client_cpu / answered, "ms");
  }
  if (options.abuse) {
    if (absl::Status status = stream_beside_abusers(stage, options, report); !status.ok()) return status;
  }
  if (options.idle > 0) {
    const absl::StatusOr<double> bytes = bytes_of_idle(stage, options, context);
    if (!bytes.ok()) return bytes.status();
    report.results.push_back({absl::StrFormat("%d clients with %d points that do nothing: memory of the server, each",
                                              options.idle, options.crowd_points),
                              *bytes / kKibi, "KiB"});
  }
  report.notes = {
      "The server has a process of its own; they talk over TCP on the loopback. Latency: from sending a view until its points "
      "are "
      "decoded. One client alone waits for each frame; those of a crowd send views "
      "whatever comes back, and a view that a newer one overtakes is not answered."};
  return report;
}

}  // namespace curvecast::cli::bench
