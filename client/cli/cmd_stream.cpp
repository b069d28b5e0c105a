#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "client/cli/camera_path.h"
#include "client/cli/commands.h"
#include "client/cli/density_term.h"
#include "client/cli/points_io.h"
#include "client/cli/progress_bar.h"
#include "client/cli/report.h"
#include "client/cli/sample_flags.h"
#include "client/cli/session_flags.h"
#include "client/lib/file_bytes.h"
#include "client/lib/view_stream.h"

namespace curvecast::cli {
namespace {

constexpr std::chrono::seconds kFrameTimeout{60};
constexpr std::size_t kMaxFrames = 100'000;

struct Flags {
  std::string mesh, path = "orbit", output;
  std::size_t frames = 60;
  SampleFlags sample;
  SessionFlags session;
};

/// One entry per frame.
struct Measured {
  std::vector<double> points, added, removed, resized, bytes, server_ms, latency_ms;
  std::size_t key_frames = 0;
  std::size_t improved = 0;      // frames that followed by themselves when the curve had become finer; in none of the above
  std::size_t short_frames = 0;  // with fewer points than wanted
  double least_share = 1;        // of the points wanted, of all frames
  std::string scarcest;          // what the frame with the least share says
};

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

std::string frame_file(const std::string& folder, std::size_t frame) {
  return (std::filesystem::path(folder) / absl::StrFormat("frame_%04d.ply", frame)).string();
}

absl::Status prepare_folder(const std::string& folder) {
  if (absl::Status status = make_folder(folder); !status.ok()) return status;
  return client::check_writable(frame_file(folder, 0));
}

absl::StatusOr<client::Frame> frame_of(client::ViewStream& stream, std::uint64_t sequence, std::size_t* improved) {
  while (true) {
    absl::StatusOr<client::Frame> frame = stream.next_frame(kFrameTimeout);
    if (!frame.ok() || frame->sequence == sequence) return frame;
    ++*improved;  // of the view before: its first frame has been taken
  }
}

absl::StatusOr<Measured> stream_views(const Flags& flags, client::ViewStream& stream, v1::SampleRequest sample,
                                      const std::vector<v1::Camera>& cameras, ProgressBar& bar) {
  Measured measured;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    sample.clear_cameras();
    *sample.add_cameras() = cameras[i];
    const auto start = std::chrono::steady_clock::now();
    absl::StatusOr<std::uint64_t> sequence = stream.send_view(sample);
    if (!sequence.ok()) return sequence.status();
    absl::StatusOr<client::Frame> frame = frame_of(stream, *sequence, &measured.improved);
    if (!frame.ok()) return frame.status();
    if (!frame->error.ok()) {
      return absl::Status(frame->error.code(), absl::StrCat("frame ", i, ": ", frame->error.message()));
    }
    measured.latency_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    const v1::FrameStatistics& s = frame->statistics;
    measured.server_ms.push_back(1e3 * (s.density_seconds() + s.equalise_seconds() + s.encode_seconds()));
    measured.points.push_back(static_cast<double>(frame->points->size()));
    measured.added.push_back(static_cast<double>(frame->added));
    measured.removed.push_back(static_cast<double>(frame->removed));
    measured.resized.push_back(static_cast<double>(frame->resized));
    if (!frame->is_delta) ++measured.key_frames;
    if (std::string text = point_limit_text(frame->points->size(), s); !text.empty()) {
      ++measured.short_frames;
      const double share = measured.points.back() / static_cast<double>(s.wanted_points());
      if (share < measured.least_share) measured.least_share = share, measured.scarcest = std::move(text);
    }
    measured.bytes.push_back(static_cast<double>(frame->encoded_bytes));
    if (!flags.output.empty()) {
      if (absl::Status status = save_points(frame_file(flags.output, i), *frame->points, {}); !status.ok()) return status;
    }
    bar.update("stream", static_cast<double>(i + 1) / static_cast<double>(cameras.size()));
  }
  return measured;
}

absl::Status report(const Flags& flags, const CommonOptions& options, const Measured& measured) {
  const std::vector<double> updates(measured.bytes.begin() + 1, measured.bytes.end());
  const auto count = [](double value) { return static_cast<std::uint64_t>(value); };
  const std::uint64_t points = count(quantile(measured.points, 0.5));
  const std::uint64_t added = count(quantile(measured.added, 0.5)), removed = count(quantile(measured.removed, 0.5));
  const std::uint64_t resized = count(quantile(measured.resized, 0.5));
  const std::uint64_t key_bytes = count(measured.bytes.front()), update_bytes = count(quantile(updates, 0.5));
  const double bytes_per_point = sum(measured.bytes) / std::max(1.0, sum(measured.added));
  const double server50 = quantile(measured.server_ms, 0.5), server99 = quantile(measured.server_ms, 0.99);
  if (measured.short_frames > 0) {
    print_note(absl::StrFormat("%d of %d frames have fewer points than wanted, at the least %s", measured.short_frames,
                               measured.points.size(), measured.scarcest));
  }
  const double latency50 = quantile(measured.latency_ms, 0.5), latency99 = quantile(measured.latency_ms, 0.99);
  if (!options.json) {
    return print_text(
        absl::StrFormat("%d frames, %d of them key frames; medians: %d points, %d added, %d removed, %d with another disc\n"
                        "bytes          first frame %d, later frames (median) %d, %.2f per point\n"
                        "server         p50 %.2f ms, p99 %.2f ms\n"
                        "latency        p50 %.2f ms, p99 %.2f ms\n"
                        "improved       %d frames came again from a finer curve\n",
                        measured.points.size(), measured.key_frames, points, added, removed, resized, key_bytes, update_bytes,
                        bytes_per_point, server50, server99, latency50, latency99, measured.improved));
  }
  Json json = {{"frames", measured.points.size()},
               {"key_frames", measured.key_frames},
               {"short_frames", measured.short_frames},
               {"points_median", points},
               {"added_median", added},
               {"removed_median", removed},
               {"resized_median", resized},
               {"key_bytes", key_bytes},
               {"delta_bytes_median", update_bytes},
               {"bytes_per_point", bytes_per_point},
               {"server_ms", {{"p50", server50}, {"p99", server99}}},
               {"latency_ms", {{"p50", latency50}, {"p99", latency99}}},
               {"improved", measured.improved}};
  if (!flags.output.empty()) json["output"] = flags.output;
  return print_json(json);
}

absl::Status run(const Flags& flags, const CommonOptions& options, std::stop_token stop) {
  if (!flags.output.empty()) {
    if (absl::Status status = prepare_folder(flags.output); !status.ok()) return status;
  }
  SampleFlags sample_flags = flags.sample;
  if (sample_flags.density.empty()) sample_flags.density = {"view"};
  absl::StatusOr<v1::SampleRequest> sample = make_request(sample_flags, options.seed);
  if (!sample.ok()) return sample.status();
  const absl::StatusOr<v1::SessionOptions> session_options =
      make_session_options(flags.session, session_points(flags.sample.points), ranks_seed(flags.sample, options.seed));
  if (!session_options.ok()) return session_options.status();
  // A broken path file is found out before the long work.
  const Box3d any_box{Vec3d(-1, -1, -1), Vec3d(1, 1, 1)};
  if (absl::Status status = make_camera_path(flags.path, 1, any_box).status(); !status.ok()) return status;

  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options, SessionCaching::kKeep);
  if (!host.ok()) return host.status();
  client::Client& client = (*host)->client();
  absl::StatusOr<OpenedMesh> opened = open_mesh(client, flags.mesh, *session_options, options.quiet, stop);
  if (!opened.ok()) return opened.status();
  absl::StatusOr<std::vector<v1::Camera>> cameras =
      make_camera_path(flags.path, flags.frames, box_of(opened->session.report().mesh()));
  if (!cameras.ok()) return cameras.status();
  ProgressBar bar(progress_style(options.quiet), std::filesystem::path(flags.mesh).filename().string());
  const std::unique_ptr<client::ViewStream> stream =
      client::ViewStream::open(*client.connection(), opened->session.session_id(), stop);
  absl::StatusOr<Measured> measured = stream_views(flags, *stream, *std::move(sample), *cameras, bar);
  if (!measured.ok()) return measured.status();
  if (absl::Status status = stream->close(); !status.ok()) return status;
  bar.finish();
  return report(flags, options, *measured);
}

}  // namespace

Command add_stream(CLI::App& root, CommonOptions& options) {
  CLI::App* app =
      add_command(root, options, "stream",
                  "Sends the views of a camera path through the streaming API, one after the other, and measures the frames "
                  "that come back. A key frame adds all of its points and removes those of the frame before; a delta, which "
                  "only the progressive sampler has, those that come and go. delta_bytes_median is over the frames after the "
                  "first, whichever they are.",
                  {"curvecast stream igea.ply --path orbit --frames 120 -n 50000",
                   "curvecast stream igea.ply --path views.txt --frames 10 -n 20000 -o frames/"});
  add_cache_flags(app, options);
  const auto flags = std::make_shared<Flags>();
  app->add_option("MESH", flags->mesh, kMeshHelp)->required();
  app->add_option("--path", flags->path, kPathHelp)->type_name("orbit|zoom|FILE")->capture_default_str();
  app->add_option("--frames", flags->frames, "number of views F, 1 to 100,000")
      ->check(CLI::Range(std::size_t{1}, kMaxFrames))
      ->type_name("F")
      ->capture_default_str();
  flags->sample.usual_sampler = "progressive";
  add_sample_flags(app, &flags->sample)->capture_default_str();
  app->get_option("--density")->description(std::string(kDensityHelp) + "; default: view");
  add_session_flags(app, &flags->session);
  app->add_option("-o,--output", flags->output, "a folder for frame_0000.ply, frame_0001.ply, ...; made if missing")
      ->type_name("DIR");
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
