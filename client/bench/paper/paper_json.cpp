#include "client/bench/paper/paper_json.h"

#include <utility>

namespace curvecast::cli::bench {
namespace {

using Json = nlohmann::ordered_json;

Json seconds_json(const StageTimes& times) {
  Json json;
  for (const TableStage& stage : kTableStages) json[stage.symbol] = times.*stage.seconds;
  return json;
}

Json table_1_row(const MeshFindings& mesh) {
  Json paper, seconds = {{"paper", nullptr}};
  if (mesh.paper != nullptr) {
    paper = {{"name", mesh.paper->name}, {"faces", mesh.paper->faces}, {"vertices", mesh.paper->vertices}};
    seconds["paper"] = seconds_json(mesh.paper->seconds);
  }
  for (const Way way : kWays) seconds[kWayNames[way]] = seconds_json(mesh.seconds[way]);
  return {{"file", mesh.file},
          {"faces", mesh.faces},
          {"vertices", mesh.vertices},
          {"paper", std::move(paper)},
          {"seconds", std::move(seconds)}};
}

Json table_2_row(const MeshFindings& mesh) {
  Json gradients = {{"paper", mesh.paper != nullptr ? Json(mesh.paper->gradient) : Json()}};
  for (const RingLine& line : mesh.rings) {
    gradients[line.name] = {{"rms", line.test.rms_gradient}, {"max", line.test.max_gradient}};
  }
  Json errors = Json::array();
  if (mesh.paper != nullptr) {
    for (const PaperError& error : mesh.paper->errors) {
      errors.push_back({{"way", "paper"}, {"percent", error.percent}, {"error", error.error}});
    }
  }
  for (const RemeshError& error : mesh.remeshes) {
    errors.push_back({{"way", error.way},
                      {"percent", error.percent},
                      {"triangles", error.triangles},
                      {"mean", error.mean},
                      {"rms", error.rms},
                      {"max", error.max}});
  }
  return {{"file", mesh.file}, {"gradients", std::move(gradients)}, {"hausdorff_percent_of_diagonal", std::move(errors)}};
}

Json figure_5_plot(const MeshFindings& mesh) {
  Json lines = Json::array();
  for (const RingLine& line : mesh.rings) {
    Json& json = lines.emplace_back(Json{{"name", line.name}});
    json["curve_vertices"] = line.curve_vertices > 0 ? Json(line.curve_vertices) : Json();
    json["rms"] = line.test.rms;
    json["max"] = line.test.max;
  }
  return {{"file", mesh.file}, {"points", mesh.ring_sizes}, {"lines", std::move(lines)}};
}

}  // namespace

Json paper_json(const PaperFindings& findings) {
  Json json = {{"name", "paper"}, {"machine", findings.machine}, {"quick", findings.quick}, {"seed", findings.seed}};
  Json& claims = json["claims"] = Json::array();
  for (const Claim& claim : claims_of(findings)) {
    claims.push_back({{"claim", claim.text}, {"ours", claim.ours}, {"paper", claim.paper}, {"holds", claim.holds}});
  }
  json["table_1"] = {{"points", findings.table_points}, {"meshes", Json::array()}};
  json["table_2"] = Json::array();
  json["figure_5"] = Json::array();
  for (const MeshFindings& mesh : findings.meshes) {
    json["table_1"]["meshes"].push_back(table_1_row(mesh));
    json["table_2"].push_back(table_2_row(mesh));
    json["figure_5"].push_back(figure_5_plot(mesh));
  }
  json["figure_6"] = {{"points", findings.square_points}, {"disc_radius", findings.disc_radius}, {"sets", Json::array()}};
  for (const SquareDiscs& square : findings.squares) {
    json["figure_6"]["sets"].push_back(
        {{"name", square.name}, {"star_discrepancy", square.star_discrepancy}, {"covered_share", square.covered}});
  }
  Json& pictures = json["pictures"] = Json::array();
  for (const Picture& picture : findings.pictures) {
    pictures.push_back({{"figure", picture.figure}, {"caption", picture.caption}});
  }
  return json;
}

}  // namespace curvecast::cli::bench
