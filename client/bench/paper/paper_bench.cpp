#include "client/bench/paper/paper_bench.h"

#include <absl/strings/str_cat.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "client/bench/paper/figures.h"
#include "client/bench/paper/generated_meshes.h"
#include "client/bench/paper/hosted_mesh.h"
#include "client/bench/paper/remesh_errors.h"
#include "client/bench/paper/ring_lines.h"
#include "client/bench/paper/square_discs.h"
#include "client/bench/paper/stage_times.h"
#include "core/base/with_threads.h"

namespace curvecast::cli::bench {
namespace {

/// How much is done.
struct Extent {
  std::uint64_t table_points;    // table 1
  int repeats;                   // of each stage
  std::uint64_t most_points;     // figure 5: of the largest set
  std::uint64_t curve_points;    // for which its curve is made
  std::uint64_t error_samples;   // of Hausdorff distances' means
  std::size_t square_points;     // figure 6
  std::uint64_t session_points;  // of sessions for pictures
  int side;                      // of pictures, pixels
};
constexpr Extent kWhole = {65'536, 3, 1'572'864, 1'600'000, 1'000'000, 3000, 65'536, 640};
constexpr Extent kQuick = {4096, 1, 4096, 4096, 20'000, 500, 8192, 240};

class PaperBench {
 public:
  PaperBench(const Extent& extent, const CommonOptions& common, const ExecutionContext& context, std::stop_token stop)
      : extent_(extent), common_(common), context_(context), options_{common.seed, extent.session_points, std::move(stop)} {}

  absl::Status run(std::span<const PaperInput> inputs, PaperFindings& findings) {
    std::vector<LoadedMesh> loaded;  // all at first: what is wrong with one shows at once
    for (const PaperInput& input : inputs) {
      absl::StatusOr<LoadedMesh> mesh = load_mesh(input.file, context_);
      if (!mesh.ok()) return mesh.status();
      loaded.push_back(*std::move(mesh));
    }
    if (absl::Status status = context_.check(); !status.ok()) return status;
    // The server's sessions are for these pictures alone: nothing goes to the user's cache.
    absl::StatusOr<std::unique_ptr<Host>> host = Host::open(common_);
    if (!host.ok()) return host.status();
    client::Client& client = (*host)->client();
    Figures figures(extent_.side, context_);
    const auto square = hosted(client, client.upload_mesh("square.obj", square_obj(), {}, options_.stop));
    if (!square.ok()) return square.status();
    absl::Status status = figures.draw_square(*square, extent_.square_points, findings.squares);
    if (!status.ok()) return status;
    const auto sphere = hosted(client, client.upload_mesh("sphere.off", sphere_off(), {}, options_.stop));
    if (!sphere.ok()) return sphere.status();
    status = figures.draw_sphere(*sphere);
    const std::size_t lead = lead_of(inputs);
    for (std::size_t i = 0; status.ok() && i < inputs.size(); ++i) {
      const auto mesh = hosted(client, client.upload_with_companions(inputs[i].path, {}, options_.stop));
      if (!mesh.ok()) return mesh.status();
      status = run_mesh(*mesh, inputs[i].file, loaded[i], i == lead, figures, findings.meshes.emplace_back());
    }
    if (!status.ok()) return status;
    findings.pictures = figures.take();
    return absl::OkStatus();
  }

 private:
  /// Which mesh has the figures that show a single one.
  static std::size_t lead_of(std::span<const PaperInput> inputs) {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const PaperMesh* const paper = paper_mesh(inputs[i].file.name);
      if (paper != nullptr && std::string_view(paper->name) == "Squirrel") return i;  // as in figure 2
    }
    return 0;
  }

  /// `uploaded`: an UploadedMesh, or the id of one.
  template <typename Uploaded>
  absl::StatusOr<HostedMesh> hosted(client::Client& client, absl::StatusOr<Uploaded> uploaded) const {
    if (!uploaded.ok()) return uploaded.status();
    return HostedMesh(client, *std::move(uploaded), options_);
  }

  absl::Status run_mesh(const HostedMesh& hosted, const MeshFile& file, const LoadedMesh& loaded, bool is_lead, Figures& figures,
                        MeshFindings& mesh) {
    const std::string name(file.name);
    ExecutionContext context = context_;
    context.on_progress = [&](std::string_view stage, double fraction) {
      context_.progress(absl::StrCat(name, ": ", std::string(stage)), fraction);
    };
    mesh.file = name;
    mesh.paper = paper_mesh(name);
    mesh.faces = loaded.info.faces;
    mesh.vertices = loaded.info.vertices;
    if (absl::Status status = measure(file, context, mesh); !status.ok()) return status;
    const bool has_105 = mesh.paper != nullptr && mesh.paper->errors.front().percent == 105;
    constexpr std::array<int, 4> kPercentages = {105, 75, 50, 25};
    auto errors = measure_remesh_errors(hosted, loaded.mesh, std::span(kPercentages).subspan(has_105 ? 0 : 1),
                                        extent_.error_samples, context);
    if (!errors.ok()) return errors.status();
    mesh.remeshes = *std::move(errors);
    if (is_lead) {
      if (absl::Status status = figures.draw_stages(hosted, loaded.mesh, name); !status.ok()) return status;
    }
    return figures.draw_samplings(hosted, name, mesh.paper);
  }

  absl::Status measure(const MeshFile& file, const ExecutionContext& context, MeshFindings& mesh) {
    for (const Way way : kWays) {
      const absl::StatusOr<StageTimes> seconds = measure_stages(file, way, extent_.table_points, extent_.repeats, context);
      if (!seconds.ok()) return seconds.status();
      mesh.seconds[way] = *seconds;
    }
    mesh.ring_sizes = ring_set_sizes(extent_.most_points);
    auto rings = measure_ring_lines(file, mesh.ring_sizes, extent_.curve_points, common_.seed, context);
    if (!rings.ok()) return rings.status();
    mesh.rings = *std::move(rings);
    return absl::OkStatus();
  }

  Extent extent_;
  const CommonOptions& common_;
  const ExecutionContext& context_;
  HostedMeshOptions options_;
};

}  // namespace

absl::StatusOr<PaperFindings> bench_paper(std::span<const PaperInput> inputs, const PaperBenchOptions& options,
                                          const CommonOptions& common, const ExecutionContext& context,
                                          const std::stop_token& stop) {
  const Extent& extent = options.quick ? kQuick : kWhole;
  PaperFindings findings{.machine = options.machine,
                         .quick = options.quick,
                         .seed = common.seed,
                         .table_points = extent.table_points,
                         .square_points = extent.square_points,
                         .disc_radius = disc_radius(extent.square_points)};
  const absl::Status status =
      with_threads(context, [&] { return PaperBench(extent, common, context, stop).run(inputs, findings); });
  if (!status.ok()) return status;
  return findings;
}

}  // namespace curvecast::cli::bench
