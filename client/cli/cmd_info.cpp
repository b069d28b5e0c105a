#include <absl/strings/str_cat.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

#include "client/cli/commands.h"
#include "client/cli/progress_bar.h"
#include "client/cli/report.h"

namespace curvecast::cli {
namespace {

Json vec_json(const v1::Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json info_json(const v1::MeshInfo& mesh, const std::string& mesh_id) {
  return {{"name", mesh.name()},
          {"format", mesh.format()},
          {"mesh_id", mesh_id},
          {"file", {{"vertices", mesh.file_vertices()}, {"polygons", mesh.file_polygons()}}},
          {"mesh", mesh_json(mesh)},
          {"area", mesh.area()},
          {"box", {{"min", vec_json(mesh.box_min())}, {"max", vec_json(mesh.box_max())}}},
          {"repairs", repairs_json(mesh.repairs())},
          {"attributes", strings_json(mesh.attributes())},
          {"warnings", strings_json(mesh.warnings())}};
}

absl::Status run(const std::string& path, const CommonOptions& options, std::stop_token stop) {
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options);
  if (!host.ok()) return host.status();
  client::Client& client = (*host)->client();
  ProgressBar bar(progress_style(options.quiet), std::filesystem::path(path).filename().string());
  absl::StatusOr<client::UploadedMesh> uploaded = client.upload_with_companions(
      path, [&](std::string_view stage, double fraction) { bar.update(stage, fraction); }, stop);
  if (!uploaded.ok()) return uploaded.status();
  absl::StatusOr<v1::MeshInfo> mesh = client.inspect(*uploaded, stop);
  if (!mesh.ok()) return mesh.status();
  bar.finish();
  return options.json ? print_json(info_json(*mesh, uploaded->mesh_id)) : print_text(mesh_text(*mesh));
}

}  // namespace

Command add_info(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(root, options, "info", "What a mesh file holds, its topology, and what repair would do.",
                              {"curvecast info bunny.obj", "curvecast info --json bunny.obj | jq .mesh.genus"});
  const auto path = std::make_shared<std::string>();
  app->add_option("MESH", *path, kMeshHelp)->required();
  return {app, [path](const CommonOptions& common, std::stop_token stop) { return run(*path, common, stop); }};
}

}  // namespace curvecast::cli
