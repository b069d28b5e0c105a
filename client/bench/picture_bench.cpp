#include "client/bench/picture_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <system_error>
#include <utility>

#include "client/bench/paper/log_plot.h"
#include "client/bench/picture/budget_mesh.h"
#include "client/bench/picture/compare_pictures.h"
#include "client/bench/picture/sent_surface.h"
#include "client/bench/scene/point_picture.h"
#include "client/bench/scene/zoom_path.h"
#include "client/bench/server/server_stage.h"
#include "client/cli/density_term.h"
#include "client/cli/report.h"
#include "client/lib/file_bytes.h"
#include "core/render/png_file.h"

namespace curvecast::cli::bench {
namespace {

constexpr double kTurn = 40;  // degrees about the line of sight from one stop to the next
constexpr const char* kWays[] = {"points for the view", "simplified mesh", "even points", "points, then the mesh"};
constexpr int kMostTries = 5;          // for a cloud of as many bytes
constexpr double kCloseEnough = 0.02;  // of the bytes

v1::SampleRequest even_cloud(std::uint64_t points) {
  v1::SampleRequest sample;
  sample.set_points(points);
  sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
  return sample;
}

/// What one way of sending something has brought by a stop.
struct Outcome {
  std::string way;
  std::uint64_t size = 0;  // points or triangles
  std::uint64_t bytes = 0;
  PictureScore score;
  Image image;
};

class PictureBench {
 public:
  PictureBench(const ShadedMesh& mesh, const ServerStage& stage, const PictureBenchOptions& options,
               const ExecutionContext& context)
      : mesh_(mesh), stage_(stage), options_(options), context_(context), simpler_(mesh), place_(front_of(mesh.mesh())) {
    size_.width = size_.height = options.size;
  }

  absl::Status run(BenchReport& report) {
    if (absl::Status status = add_density_terms(options_.density, &density_); !status.ok()) return status;
    if (absl::Status status = ask_for_surface(); !status.ok()) return status;
    for (std::size_t stop = 0; stop < options_.distances.size(); ++stop) {
      if (absl::Status status = add_reference(stop); !status.ok()) return status;
    }
    for (const std::uint64_t points : options_.points) {
      if (absl::Status status = go(points, report); !status.ok()) return status;
    }
    return options_.pictures.empty() ? absl::OkStatus() : write_charts();
  }

 private:
  v1::Camera camera_at(double stop) const {
    const auto before = static_cast<std::size_t>(stop);
    const double from = options_.distances[before], to = options_.distances[std::min(before + 1, options_.distances.size() - 1)];
    const double distance = from * std::pow(to / from, stop - static_cast<double>(before)) * stage_.box().diagonal();
    return camera_above(place_, distance, kTurn * stop);
  }

  absl::Status add_reference(std::size_t stop) {
    const RenderCamera camera = camera_from(camera_at(static_cast<double>(stop)), Vec3d::Zero());
    auto reference = PictureReference::draw([&](const RenderOptions& o) { return mesh_.draw(camera, o, context_); }, size_);
    if (!reference.ok()) return reference.status();
    references_.push_back(*std::move(reference));
    return absl::OkStatus();
  }

  absl::Status ask_for_surface() {
    absl::StatusOr<SentSurface> surface = fetch_surface(stage_.connect(), stage_.session_id());
    if (absl::IsFailedPrecondition(surface.status()) || absl::IsOutOfRange(surface.status())) return absl::OkStatus();
    if (surface.ok()) surface_ = *std::move(surface);
    return surface.status();
  }

  v1::SampleRequest view(std::uint64_t points, const v1::Camera& camera) const {
    v1::SampleRequest sample;
    sample.set_points(points);
    sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
    *sample.mutable_density() = density_;
    *sample.add_cameras() = camera;
    sample.mutable_viewport()->set_width(static_cast<std::uint32_t>(options_.size));
    sample.mutable_viewport()->set_height(static_cast<std::uint32_t>(options_.size));
    return sample;
  }

  /// Comes down with views of so many points.
  absl::Status go(std::uint64_t points, BenchReport& report) {
    const std::shared_ptr<client::Connection> connection = stage_.connect();
    const auto stream = client::ViewStream::open(*connection, stage_.session_id());
    BenchTable table{absl::StrFormat("N = %d", points),
                     {"distance/size", "way", "points or triangles", "KiB", "FLIP", "PSNR dB", "SSIM", "outline px", "holes px"},
                     {}};
    std::uint64_t bytes = 0;
    std::uint64_t with_mesh = 0;  // bytes that come in all where the mesh is sent once that is better; 0: not yet
    for (std::size_t stop = 0; stop < options_.distances.size(); ++stop) {
      context_.progress(absl::StrFormat("N = %d", points),
                        static_cast<double>(stop) / static_cast<double>(options_.distances.size()));
      client::Frame frame;
      for (int step = stop == 0 ? options_.steps : 1; step <= options_.steps; ++step) {
        const double at = stop == 0 ? 0 : static_cast<double>(stop - 1) + static_cast<double>(step) / options_.steps;
        if (with_mesh == 0 && surface_.mesh != nullptr && is_mesh_better(mesh_.mesh().face_count(), bytes, points)) {
          with_mesh = bytes + surface_.bytes;
        }
        auto answered = settled(*stream, view(points, camera_at(at)), bytes);
        if (!answered.ok()) return answered.status();
        frame = *std::move(answered);
      }
      absl::StatusOr<std::vector<Outcome>> outcomes = compare(stop, *frame.points, bytes, with_mesh);
      if (!outcomes.ok()) return outcomes.status();
      for (const Outcome& outcome : *outcomes) {
        const PictureScore& s = outcome.score;
        table.rows.push_back({options_.distances[stop], outcome.way, outcome.size, static_cast<double>(outcome.bytes) / 1024,
                              s.flip, std::isfinite(s.psnr) ? Json(s.psnr) : Json(), s.ssim, s.outline, s.holes});
      }
      report.results.push_back({absl::StrFormat("FLIP at %g of the size, N = %d, %d KiB (reference: the mesh)",
                                                options_.distances[stop], points, bytes / 1024),
                                (*outcomes)[0].score.flip, "", (*outcomes)[1].score.flip});
      if (absl::Status status = keep(stop, points, *outcomes); !status.ok()) return status;
    }
    report.tables.push_back(std::move(table));
    return absl::OkStatus();
  }

  /// Sends a view and waits for its last frame; adds the bytes of all its frames.
  static absl::StatusOr<client::Frame> settled(client::ViewStream& stream, const v1::SampleRequest& sample,
                                               std::uint64_t& bytes) {
    const absl::StatusOr<std::uint64_t> sequence = stream.send_view(sample);
    if (!sequence.ok()) return sequence.status();
    while (true) {
      absl::StatusOr<client::Frame> frame = stream.next_frame(std::chrono::minutes(10));
      if (!frame.ok()) return frame.status();
      if (!frame->error.ok()) return frame->error;
      bytes += frame->encoded_bytes;
      if (frame->sequence == *sequence && !frame->statistics.refining()) return frame;
    }
  }

  absl::StatusOr<std::vector<Outcome>> compare(std::size_t stop, const client::Points& points, std::uint64_t bytes,
                                               std::uint64_t with_mesh) {
    const v1::Camera camera = camera_at(static_cast<double>(stop));
    std::vector<Outcome> outcomes(3);
    outcomes[0] = {kWays[0], points.size(), bytes, {}, {}};
    auto drawn = references_[stop].score([&](const RenderOptions& o) { return draw(points, camera, o); }, outcomes[0].image);
    if (!drawn.ok()) return drawn.status();
    outcomes[0].score = *drawn;
    const absl::StatusOr<BudgetMesh> simpler = simpler_.of_bytes(bytes, context_);
    if (!simpler.ok()) return simpler.status();
    outcomes[1] = {kWays[1], simpler->smooth->mesh().face_count(), simpler->bytes, {}, {}};
    const RenderCamera from = camera_from(camera, Vec3d::Zero());
    for (const ShadedMesh* const mesh : {simpler->smooth.get(), simpler->creased.get()}) {
      Image image;
      drawn = references_[stop].score([&](const RenderOptions& o) { return mesh->draw(from, o, context_); }, image);
      if (!drawn.ok()) return drawn.status();
      if (!outcomes[1].image.rgba.empty() && drawn->flip >= outcomes[1].score.flip) continue;
      outcomes[1].score = *drawn;
      outcomes[1].image = std::move(image);
    }
    const absl::StatusOr<client::Frame> cloud = cloud_of_bytes(bytes);
    if (!cloud.ok()) return cloud.status();
    outcomes[2] = {kWays[2], cloud->points->size(), cloud->encoded_bytes, {}, {}};
    drawn = references_[stop].score([&](const RenderOptions& o) { return draw(*cloud->points, camera, o); }, outcomes[2].image);
    if (!drawn.ok()) return drawn.status();
    outcomes[2].score = *drawn;
    if (with_mesh == 0) return outcomes;
    Outcome& sent = outcomes.emplace_back(Outcome{kWays[3], mesh_.mesh().face_count(), with_mesh, {}, {}});
    drawn = references_[stop].score([&](const RenderOptions& o) { return surface_.mesh->draw(from, o, context_); }, sent.image);
    if (!drawn.ok()) return drawn.status();
    sent.score = *drawn;
    return outcomes;
  }

  absl::StatusOr<Image> draw(const client::Points& points, const v1::Camera& camera, const RenderOptions& options) const {
    return draw_points(points, camera, options, true, mesh_.crease_degrees());
  }

  /// Points spread evenly over the whole surface that take about so many bytes.
  absl::StatusOr<client::Frame> cloud_of_bytes(std::uint64_t bytes) {
    double points = static_cast<double>(bytes) / 3;
    for (int i = 1;; ++i) {
      const std::shared_ptr<client::Connection> connection = stage_.connect();
      const auto stream = client::ViewStream::open(*connection, stage_.session_id(), {}, {.deltas = false});
      absl::StatusOr<client::Frame> frame =
          answer(*stream, even_cloud(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(points))), true);
      if (!frame.ok()) return frame.status();
      const double ratio = static_cast<double>(bytes) / static_cast<double>(frame->encoded_bytes);
      if (i == kMostTries || std::abs(ratio - 1) < kCloseEnough) return frame;
      points *= ratio;
    }
  }

  absl::Status keep(std::size_t stop, std::uint64_t points, const std::vector<Outcome>& outcomes) {
    for (const Outcome& outcome : outcomes) {
      PlotLine& line = lines_[stop][outcome.way];
      line.name = outcome.way;
      line.x.push_back(static_cast<double>(outcome.bytes) / 1024);
      line.y.push_back(outcome.score.flip);
    }
    if (options_.pictures.empty()) return absl::OkStatus();
    Image row = references_[stop].image();
    for (const Outcome& outcome : outcomes) row = beside(row, outcome.image);
    return write(absl::StrFormat("%d_%d.png", points, stop + 1), encode_png(row));
  }

  static Image beside(const Image& left, const Image& right) {
    Image both{left.width + right.width, left.height, {}};
    for (int y = 0; y < left.height; ++y) {
      for (const Image* const image : {&left, &right}) {
        const auto begin = image->rgba.begin() + std::ptrdiff_t{4} * y * image->width;
        both.rgba.insert(both.rgba.end(), begin, begin + std::ptrdiff_t{4} * image->width);
      }
    }
    return both;
  }

  absl::Status write_charts() const {
    const std::map<std::string, const char*> colours = {
        {kWays[0], "#c0392b"}, {kWays[1], "#2471a3"}, {kWays[2], "#7f8c8d"}, {kWays[3], "#d68910"}};
    for (const auto& [stop, ways] : lines_) {
      std::vector<PlotLine> lines;
      for (const char* const way : kWays) {
        if (!ways.contains(way)) continue;
        lines.push_back(ways.at(way));
        lines.back().colour = colours.at(way);
      }
      const std::string svg =
          log_plot(absl::StrFormat("from %g of the size", options_.distances[stop]), "KiB so far", "FLIP", lines);
      if (absl::Status status = write(absl::StrFormat("chart_%d.svg", stop + 1), svg); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status write(const std::string& name, const absl::StatusOr<std::string>& bytes) const {
    if (!bytes.ok()) return bytes.status();
    return client::write_bytes((std::filesystem::path(options_.pictures) / name).string(), *bytes);
  }

  const ShadedMesh& mesh_;
  const ServerStage& stage_;
  const PictureBenchOptions& options_;
  const ExecutionContext& context_;
  BudgetMeshes simpler_;
  SentSurface surface_;  // no mesh: the session sends points only
  const SurfacePlace place_;
  RenderOptions size_;
  google::protobuf::RepeatedPtrField<v1::DensityTerm> density_;
  std::vector<PictureReference> references_;                      // of each stop
  std::map<std::size_t, std::map<std::string, PlotLine>> lines_;  // of each stop, by way
};

absl::Status check(const PictureBenchOptions& options) {
  const bool is_way_down = std::ranges::is_sorted(options.distances, std::greater<>());
  if (options.points.empty() || options.distances.empty() || options.distances.back() <= 0 || !is_way_down || options.steps < 1 ||
      options.size < 16) {
    return absl::InvalidArgumentError("pictures need points, stops that come nearer and nearer, steps, and at least 16 pixels");
  }
  if (options.pictures.empty()) return absl::OkStatus();
  std::error_code error;
  std::filesystem::create_directories(options.pictures, error);
  if (!error) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(options.pictures, ": cannot be made: ", error.message()));
}

}  // namespace

absl::StatusOr<BenchReport> bench_picture(const MeshFile& file, const PictureBenchOptions& options,
                                          const ExecutionContext& context) {
  if (absl::Status status = check(options); !status.ok()) return status;
  absl::StatusOr<LoadedMesh> loaded = load_mesh(file, context);
  if (!loaded.ok()) return loaded.status();
  const ShadedMesh mesh(*std::move(loaded));
  const auto stage = ServerStage::open(file, *std::ranges::max_element(options.points), options.command, context);
  if (!stage.ok()) return stage.status();
  BenchReport report{.name = "picture", .results = {}};
  if (absl::Status status = PictureBench(mesh, *stage, options, context).run(report); !status.ok()) return status;
  report.notes = {
      absl::StrFormat(
          "A camera of 45 degrees, %d x %d pixels, comes down to the surface in %d views from stop to stop, and waits at "
          "each until nothing better follows. KiB: all bytes of points since the stream was opened; of the others, what "
          "they take once, whole. The server has a process of its own.",
          options.size, options.size, options.steps),
      absl::StrFormat(
          "Against the mesh of %d triangles itself, drawn with 16 samples a pixel; the others with 4, in the same light. "
          "FLIP: 0 is the same. outline: pixels within two of the mesh's outline on the wrong side of it; holes: others "
          "within it that nothing covers.",
          mesh.mesh().face_count()),
      "simplified mesh: meshoptimizer and Draco (positions of 12 bits; normals are computed, with "
      "creases or without, as the picture is better); even points: those of lowest rank, whatever is seen; points, then the "
      "mesh: "
      "what the viewer's automatic budget has sent, from where the mesh takes fewer bytes than the points would."};
  return report;
}

}  // namespace curvecast::cli::bench
