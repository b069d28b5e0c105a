#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "client/cli/commands.h"
#include "client/cli/report.h"
#include "client/cli/session_flags.h"

namespace curvecast::cli {
namespace {

struct Flags {
  std::string mesh;
  std::uint64_t points = 65'536;
  SessionFlags session;
};

absl::Status run(const Flags& flags, const CommonOptions& options, std::stop_token stop) {
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options, SessionCaching::kKeep);
  if (!host.ok()) return host.status();
  const absl::StatusOr<v1::SessionOptions> session_options = make_session_options(flags.session, flags.points, options.seed);
  if (!session_options.ok()) return session_options.status();
  absl::StatusOr<OpenedMesh> opened = open_mesh((*host)->client(), flags.mesh, *session_options, options.quiet, stop);
  if (!opened.ok()) return opened.status();
  if (opened->session.cached() && !options.quiet) {
    std::fprintf(stderr, "note: taken from the cache: the seconds are those of the run that made it\n");
  }
  return options.json ? print_json(preprocess_json(opened->session)) : print_text(preprocess_text(opened->session));
}

}  // namespace

Command add_preprocess(CLI::App& root, CommonOptions& options) {
  CLI::App* app =
      add_command(root, options, "preprocess",
                  "Prepares a mesh: repair, cut, parameterisation and the Hilbert curve on its surface; says what each "
                  "stage took and how good it is. The result is kept in a cache (--cache) for all commands; what is taken from "
                  "there comes with the seconds of the run that made it. With --server, the session stays there, ready for all "
                  "clients.",
                  {"curvecast preprocess bunny.obj", "curvecast preprocess -n 1000000 --omega 10 --json igea.ply",
                   "curvecast preprocess --base-density curvature igea.ply"});
  add_cache_flags(app, options);
  const auto flags = std::make_shared<Flags>();
  app->add_option("MESH", flags->mesh, kMeshHelp)->required();
  app->add_option("-n,--points", flags->points, "N for which the curve is made fine enough, 1 to 4,000,000")
      ->check(point_count_range())
      ->type_name("N")
      ->capture_default_str();
  add_session_flags(app, &flags->session);
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
