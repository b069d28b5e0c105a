#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "client/cli/commands.h"
#include "client/cli/density_term.h"
#include "client/cli/points_io.h"
#include "client/cli/progress_bar.h"
#include "client/cli/report.h"
#include "client/cli/sample_flags.h"

namespace curvecast::cli {
namespace {

constexpr std::size_t kMaxSets = 64;  // as in the API
constexpr double kFarOff = 1;         // mean distance of points from their mesh, in % of its size, that makes one wonder

struct Flags {
  std::string mesh;
  std::vector<std::string> points;
  SampleFlags sample;  // density and camera only
  std::uint32_t ring_seeds = 256, ball_centres = 1024;
  std::string other;  // mesh; empty: none
  std::uint64_t distance_samples = 1'000'000;
};

Json discrepancy_json(const v1::Discrepancy& discrepancy) {
  return {{"max", discrepancy.max()}, {"rms", discrepancy.rms()}, {"rms_relative", discrepancy.rms_relative()}};
}

Json set_json(const std::string& path, const v1::PointMeasures& set) {
  return {{"file", path},
          {"points", set.points()},
          {"on_surface", {{"max", set.on_surface().max()}, {"mean", set.on_surface().mean()}}},
          {"ring_discrepancy", discrepancy_json(set.ring_discrepancy())},
          {"ball_discrepancy", discrepancy_json(set.ball_discrepancy())},
          {"spacing",
           {{"rho", set.spacing().rho()},
            {"rho_same_side", set.spacing().rho_same_side()},
            {"nn_mean", set.spacing().nn_mean()},
            {"nn_max", set.spacing().nn_max()},
            {"coverage", set.spacing().coverage()}}}};
}

Json distance_json(const std::string& path, const v1::MeshDistance& distance) {
  const auto one_way = [](const v1::OneWayDistance& side) {
    const v1::Vec3& p = side.farthest();
    Json json = {{"max", side.max()},
                 {"mean", side.mean()},
                 {"rms", side.rms()},
                 {"farthest", {p.x(), p.y(), p.z()}},
                 {"normal_mean", side.normal_mean()},
                 {"normal_rms", side.normal_rms()}};
    if (side.picture_share() > 0) {
      json["picture"] = {{"max", side.picture_max()},
                         {"mean", side.picture_mean()},
                         {"rms", side.picture_rms()},
                         {"share", side.picture_share()}};
    }
    return json;
  };
  return {{"file", path},
          {"max", distance.max()},
          {"diagonal", distance.diagonal()},
          {"from_mesh", one_way(distance.from_mesh())},
          {"from_other", one_way(distance.from_other())}};
}

/// One set is the object itself; several are its `sets`.
Json report_json(const Flags& flags, const CommonOptions& options, const v1::Measures& measures, double seconds) {
  Json json;
  if (measures.sets_size() == 1) {
    json = set_json(flags.points[0], measures.sets(0));
  } else if (measures.sets_size() > 1) {
    json["sets"] = Json::array();
    for (int s = 0; s < measures.sets_size(); ++s) json["sets"].push_back(set_json(flags.points[s], measures.sets(s)));
  }
  if (measures.has_gradient()) {
    const v1::MeasureGradients& gradient = measures.gradient();
    json["gradient"] = {{"ring_max", gradient.ring_max()},
                        {"ring_rms", gradient.ring_rms()},
                        {"ball_max", gradient.ball_max()},
                        {"ball_rms", gradient.ball_rms()}};
  }
  if (measures.has_distance()) json["distance"] = distance_json(flags.other, measures.distance());
  json["seed"] = options.seed;
  json["seconds"] = seconds;
  return json;
}

std::string distance_text(const Flags& flags, const v1::MeshDistance& distance) {
  const auto name_of = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  std::string text = absl::StrFormat("distance of %s and %s, %% of the diagonal %.6g\n", name_of(flags.mesh),
                                     name_of(flags.other), distance.diagonal());
  absl::StrAppendFormat(&text, "             max     mean      rms   normals, degrees: mean      rms\n");
  const auto add = [&](const char* what, const v1::OneWayDistance& side) {
    absl::StrAppendFormat(&text, "%-8s %8.4f %8.5f %8.5f                     %7.3f  %7.3f\n", what, side.max(), side.mean(),
                          side.rms(), side.normal_mean(), side.normal_rms());
  };
  add("from", distance.from_mesh());
  add("back", distance.from_other());
  absl::StrAppendFormat(&text, "both     %8.4f\n", distance.max());
  const auto add_picture = [&](const char* what, const v1::OneWayDistance& side) {
    if (side.picture_share() == 0) return;
    absl::StrAppendFormat(&text, "%-8s %8.4f %8.5f %8.5f   pixels of the camera, of %.1f %% of the surface\n", what,
                          side.picture_max(), side.picture_mean(), side.picture_rms(), 100 * side.picture_share());
  };
  add_picture("from", distance.from_mesh());
  add_picture("back", distance.from_other());
  return text;
}

std::string report_text(const Flags& flags, const v1::Measures& measures) {
  if (measures.sets_size() == 0) return distance_text(flags, measures.distance());
  std::size_t width = 8;
  std::vector<std::string> names;
  for (const std::string& path : flags.points) {
    names.push_back(std::filesystem::path(path).filename().string());
    width = std::max(width, names.back().size());
  }
  const int columns = static_cast<int>(width);
  std::string text = absl::StrFormat(
      "%-*s           off surface, %%   ring discrepancy            ball discrepancy            spacing\n", columns, "");
  absl::StrAppendFormat(
      &text, "%-*s   points     max    mean       max      rms of random       max      rms of random    rho   mean  coverage\n",
      columns, "");
  for (int s = 0; s < measures.sets_size(); ++s) {
    const v1::PointMeasures& set = measures.sets(s);
    const v1::Discrepancy &ring = set.ring_discrepancy(), &ball = set.ball_discrepancy();
    absl::StrAppendFormat(&text, "%-*s %8d %7.4f %7.4f  %8.2e %8.2e %9.4f  %8.2e %8.2e %9.4f  %5.3f  %5.3f  %8.3f\n", columns,
                          names[s], set.points(), set.on_surface().max(), set.on_surface().mean(), ring.max(), ring.rms(),
                          ring.rms_relative(), ball.max(), ball.rms(), ball.rms_relative(), set.spacing().rho(),
                          set.spacing().nn_mean(), set.spacing().coverage());
  }
  if (measures.has_gradient()) {
    const v1::MeasureGradients& gradient = measures.gradient();
    absl::StrAppendFormat(&text, "%-*s                           %8.3f %8.3f            %8.3f %8.3f\n", columns, "gradient",
                          gradient.ring_max(), gradient.ring_rms(), gradient.ball_max(), gradient.ball_rms());
  }
  if (measures.has_distance()) absl::StrAppend(&text, distance_text(flags, measures.distance()));
  return text;
}

absl::StatusOr<std::vector<client::Points>> load_sets(const std::vector<std::string>& paths, const std::stop_token& stop) {
  std::vector<client::Points> sets;
  for (const std::string& path : paths) {
    if (stop.stop_requested()) return absl::CancelledError("cancelled");
    absl::StatusOr<client::Points> points = load_points(path);
    if (!points.ok()) return points.status();
    if (points->size() < 2) {
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": holds too few points, ", points->size(), "; at least 2 can be measured"));
    }
    sets.push_back(*std::move(points));
  }
  return sets;
}

absl::StatusOr<v1::MeasureRequest> make_measure_request(const Flags& flags, const CommonOptions& options, client::Client& client,
                                                        const client::UploadedMesh& mesh, const std::stop_token& stop) {
  v1::MeasureRequest request;
  request.set_seed(options.seed);
  request.set_ring_seeds(flags.ring_seeds);
  request.set_ball_centres(flags.ball_centres);
  if (absl::Status status = add_density_terms(flags.sample.density, request.mutable_density()); !status.ok()) return status;
  const bool in_pixels = !flags.other.empty() && !flags.sample.cameras.empty();
  if (!in_pixels && std::none_of(request.density().begin(), request.density().end(), is_camera_term)) return request;
  const absl::StatusOr<v1::MeshInfo> info = client.inspect(mesh, stop);
  if (!info.ok()) return info.status();
  const absl::StatusOr<Cameras> cameras = cameras_of(flags.sample, box_of(*info));
  if (!cameras.ok()) return cameras.status();
  *request.mutable_cameras() = {cameras->all.begin(), cameras->all.end()};
  *request.mutable_viewport() = cameras->viewport();
  return request;
}

void tell_far_sets(const Flags& flags, const v1::Measures& measures) {
  for (int s = 0; s < measures.sets_size(); ++s) {
    const double mean = measures.sets(s).on_surface().mean();
    if (mean <= kFarOff) continue;
    std::fprintf(
        stderr,
        "note: %s: its points lie off the surface, %.3g %% of the mesh's size on average; were they made for this mesh?\n",
        flags.points[s].c_str(), mean);
  }
}

absl::Status run(const Flags& flags, const CommonOptions& options, std::stop_token stop) {
  const auto start = std::chrono::steady_clock::now();
  const absl::StatusOr<std::vector<client::Points>> sets = load_sets(flags.points, stop);
  if (!sets.ok()) return sets.status();
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options);
  if (!host.ok()) return host.status();
  client::Client& client = (*host)->client();
  ProgressBar bar(progress_style(options.quiet), std::filesystem::path(flags.mesh).filename().string());
  const client::StageProgress on_progress = [&](std::string_view stage, double fraction) { bar.update(stage, fraction); };
  const absl::StatusOr<client::UploadedMesh> mesh = client.upload_with_companions(flags.mesh, on_progress, stop);
  if (!mesh.ok()) return mesh.status();
  absl::StatusOr<v1::MeasureRequest> request = make_measure_request(flags, options, client, *mesh, stop);
  if (!request.ok()) return request.status();
  if (!flags.other.empty()) {
    const absl::StatusOr<client::UploadedMesh> other = client.upload_with_companions(flags.other, on_progress, stop);
    if (!other.ok()) return other.status();
    request->set_other_mesh_id(other->mesh_id);
    request->mutable_other_companions()->insert(other->companions.begin(), other->companions.end());
    request->set_distance_samples(flags.distance_samples);
  }
  const absl::StatusOr<v1::Measures> measures = client.measure(*mesh, *sets, *std::move(request), on_progress, stop);
  if (!measures.ok()) return measures.status();
  bar.finish();
  if (!options.quiet) tell_far_sets(flags, *measures);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return options.json ? print_json(report_json(flags, options, *measures, seconds.count()))
                      : print_text(report_text(flags, *measures));
}

}  // namespace

Command add_measure(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "measure",
      "How evenly points lie on a mesh, whoever made them. Discrepancy: how far shares of the points are from shares of the "
      "area, over "
      "rings of triangles and over balls, and its RMS as a part of what random points have. Spacing, 1 in a hexagonal lattice: "
      "rho of the "
      "two nearest points, mean of all nearest neighbours; coverage: the largest hole's radius, 1.155 in that lattice. With "
      "several "
      "sets: gradient, the power of N by which the discrepancies fall; random points have -0.5, and -0.75 is best. With --mesh, "
      "how "
      "far another mesh lies from this one and the other way round: the Hausdorff distance, means, angles between normals; with "
      "--camera in its pixels too.",
      {"curvecast measure bunny.obj bunny.ply", "curvecast measure igea.ply a4k.ply a64k.ply a256k.ply --json | jq .gradient",
       "curvecast measure igea.ply curved.drc --density curvature", "curvecast measure igea.ply --mesh simplified.obj",
       "curvecast measure igea.ply --mesh simplified.obj --camera fov=20"});
  const auto flags = std::make_shared<Flags>();
  app->add_option("MESH", flags->mesh, kMeshHelp)->required();
  app->add_option("POINTS", flags->points, "up to 64 files of points: .ply, .xyz, .pcd or .drc; may be left out beside --mesh")
      ->expected(0, static_cast<int>(kMaxSets))
      ->check(validator(check_points_ending, ""))
      ->type_name("FILE");
  add_density_flag(app, &flags->sample,
                   "the density that the points are to have, and are compared with; as of sample; default: uniform");
  add_camera_flag(app, &flags->sample, true);
  const auto add_count = [&](const char* name, std::uint32_t* count, const char* help) {
    app->add_option(name, *count, help)->check(CLI::Range(1u, 100'000u))->type_name("COUNT")->capture_default_str();
  };
  app->parse_complete_callback([flags] {
    if (flags->points.empty() && flags->other.empty()) throw CLI::RequiredError("POINTS, or another mesh with --mesh,");
  });
  add_count("--ring-seeds", &flags->ring_seeds, "random triangles that rings are grown around");
  app->add_option("--mesh", flags->other, "another mesh, whose distance is measured: its simplification or remeshing, say")
      ->type_name("FILE");
  app->add_option("--distance-samples", flags->distance_samples, "places of each mesh that its means are taken over")
      ->check(CLI::Range(std::uint64_t{1'000}, std::uint64_t{100'000'000}))
      ->type_name("COUNT")
      ->capture_default_str();
  add_count("--ball-centres", &flags->ball_centres, "random points of the surface with four balls about each");
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
