#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <system_error>

#include "client/cli/commands.h"
#include "client/cli/points_io.h"
#include "client/cli/sample/mesh_sampling.h"
#include "client/lib/file_bytes.h"
#include "proto/formats/tileset.h"
#include "proto/terms/density_term.h"

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Flags {
  std::string mesh, folder;
  SamplingFlags sampling;
  formats::TilesetOptions tileset;
  std::string up = "y", content = "meshopt";
};

/// Makes the folder ready for a set: where there is one of ours already, that goes. FailedPrecondition: it holds something else.
absl::Status clear(const std::string& folder) {
  if (absl::Status status = make_folder(folder); !status.ok()) return status;
  std::vector<fs::path> old;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name != formats::kTilesetName && !formats::is_tile_name(name)) {
      return absl::FailedPreconditionError(absl::StrCat(folder, " holds ", name, ", which is no tile: name an empty folder"));
    }
    old.push_back(entry.path());
  }
  // The set's own file first: without it the others are no set.
  std::partition(old.begin(), old.end(), [](const fs::path& path) { return path.filename() == formats::kTilesetName; });
  for (const fs::path& path : old) {
    if (!error) fs::remove(path, error);
  }
  return error ? absl::FailedPreconditionError(absl::StrCat(folder, ": ", error.message())) : absl::OkStatus();
}

struct Written {
  std::uint64_t tiles = 0, files = 0, bytes = 0;
};

absl::StatusOr<Written> write_tiles(const Flags& flags, const client::Points& points, const std::stop_token& stop) {
  Written written;
  absl::Status status = formats::make_tileset(columns_of(points), flags.tileset, [&](formats::TileFile file) -> absl::Status {
    if (stop.stop_requested()) return absl::CancelledError("cancelled");
    ++written.files;
    written.tiles += fs::path(file.name).extension() == ".glb";
    written.bytes += file.bytes.size();
    return client::write_bytes((fs::path(flags.folder) / file.name).string(), file.bytes);
  });
  if (!status.ok()) return status;
  return written;
}

absl::Status report(const Flags& flags, const CommonOptions& options, std::size_t points, const Written& written,
                    double seconds) {
  if (options.json) {
    return print_json({{"points", points},
                       {"tiles", written.tiles},
                       {"files", written.files},
                       {"bytes", written.bytes},
                       {"seconds", seconds},
                       {"output", (fs::path(flags.folder) / formats::kTilesetName).string()}});
  }
  return print_text(absl::StrFormat("%d points in %d tiles, %.1f MB, %.1f s\nwritten        %s\n", points, written.tiles,
                                    1e-6 * static_cast<double>(written.bytes), seconds,
                                    (fs::path(flags.folder) / formats::kTilesetName).string()));
}

absl::Status run(Flags flags, const CommonOptions& options, std::stop_token stop) {
  const Clock::time_point start = Clock::now();
  flags.tileset.z_up = flags.up == "z";
  flags.tileset.content = {.quantise = flags.content != "floats", .compress = flags.content == "meshopt"};
  const absl::StatusOr<SamplingRequests> requests = make_sampling_requests(flags.sampling, options.seed, "tiles.glb");
  if (!requests.ok()) return requests.status();
  const auto& density = requests->sample.density();
  if (std::any_of(density.begin(), density.end(), terms::is_camera_term)) {
    return absl::InvalidArgumentError("--density: a term depends on a camera, and tiles are the same for all of them");
  }
  if (absl::Status status = clear(flags.folder); !status.ok()) return status;
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options, SessionCaching::kKeep);
  if (!host.ok()) return host.status();
  const absl::StatusOr<SampledMesh> sampled =
      open_and_sample((*host)->client(), flags.mesh, *requests, flags.sampling, options.quiet, stop);
  if (!sampled.ok()) return sampled.status();
  const client::Points& points = sampled->sample.points;
  const absl::StatusOr<Written> written = write_tiles(flags, points, stop);
  if (!written.ok()) return written.status();
  return report(flags, options, points.size(), *written, std::chrono::duration<double>(Clock::now() - start).count());
}

}  // namespace

Command add_tiles(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "tiles",
      "Writes points on a mesh as 3D Tiles 1.1, which Cesium, 3d-tiles-renderer (three.js) and others load by what they look at, "
      "from any "
      "web server.\n\n"
      "A tile holds the points of one part of the curve and of one octave of ranks. Finer tiles add to coarser ones: no point is "
      "in two, "
      "and the first levels are an even, coarser set of the points. Tiles are glTF; the geometric error of each is the largest "
      "distance to a point that only finer tiles have.",
      {"curvecast tiles igea.ply -n 4000000 -o igea_tiles", "curvecast tiles city.obj -n 1000000 --up z -o city"});
  add_cache_flags(app, options);
  const auto flags = std::make_shared<Flags>();
  flags->sampling.sample.points = 1'000'000;
  flags->sampling.sample.sampler = "progressive";
  app->add_option("MESH", flags->mesh, kMeshHelp)->required();
  app->add_option("-o,--output", flags->folder, "the folder of the tiles; what it holds of an earlier set goes")
      ->required()
      ->type_name("DIR");
  app->add_option("-n,--points", flags->sampling.sample.points, "in all tiles together")
      ->check(point_count_range())
      ->capture_default_str();
  add_density_flag(
      app, &flags->sampling.sample,
      "a factor of the density, one of no camera: curvature, attribute, brush, expression, as `curvecast sample --help` "
      "has them; repeat to multiply");
  app->add_option("--root-points", flags->tileset.root_points, "in the coarsest tile; each level has four times as many")
      ->check(CLI::Range(64u, 1'000'000u))
      ->capture_default_str();
  app->add_option("--content", flags->content,
                  "how tiles hold numbers: meshopt (EXT_meshopt_compression, the smallest), quantised (KHR_mesh_quantization) or "
                  "floats (as they are)")
      ->check(CLI::IsMember({"meshopt", "quantised", "floats"}))
      ->capture_default_str();
  app->add_option("--up", flags->up, "the axis of the mesh that points upwards")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
