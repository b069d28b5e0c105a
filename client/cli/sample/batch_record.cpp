#include "client/cli/sample/batch_record.h"

#include <absl/strings/str_cat.h>
#include <google/protobuf/util/json_util.h>

#include <cstdint>
#include <utility>

#include "client/lib/companion_files.h"
#include "client/lib/file_bytes.h"
#include "server/base/build_info.h"

namespace curvecast::cli {
namespace {

constexpr std::uint64_t kMostRecordBytes = 1 << 20;
constexpr char kSettings[] = "settings", kCompanions[] = "companions", kState[] = "state", kMaking[] = "making";

/// Names of files need not be UTF-8.
std::string line_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

absl::StatusOr<Json> to_json(const google::protobuf::Message& message) {
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text);
  if (!status.ok()) return absl::InternalError(absl::StrCat("a request cannot be written: ", std::string(status.message())));
  return Json::parse(text);
}

/// The id of a file that a mesh refers to; null where it is not there.
absl::StatusOr<Json> companion_id(const std::string& mesh, const std::string& name, const std::stop_token& stop) {
  const absl::StatusOr<client::InputFile> file = client::open_companion(mesh, name);
  if (!file.ok()) return Json();
  const absl::StatusOr<std::string> sha256 = client::sha256_of(*file, stop);
  if (!sha256.ok()) return sha256.status();
  return Json(client::mesh_id_of_sha256(*sha256));
}

}  // namespace

std::optional<Json> read_record(const std::string& path) {
  const absl::StatusOr<std::string> bytes = client::read_bytes(path, kMostRecordBytes);
  if (!bytes.ok()) return std::nullopt;
  Json record = Json::parse(*bytes, nullptr, false);
  if (!record.is_object()) return std::nullopt;
  return record;
}

absl::Status write_record(const std::string& path, const Json& record) { return client::write_bytes(path, line_of(record)); }

Json record_of_making(const PlannedMesh& mesh) { return {{"mesh", mesh.mesh}, {kState, kMaking}}; }

bool is_of_making(const Json& record) { return record.contains(kState) && record[kState] == kMaking; }

absl::StatusOr<Json> settings_json(const BatchSettings& settings) {
  const absl::StatusOr<SamplingRequests> requests =
      make_sampling_requests(settings.sampling, settings.seed, settings.output_of("x"));
  if (!requests.ok()) return requests.status();
  absl::StatusOr<Json> session = to_json(requests->session);
  if (!session.ok()) return session;
  Json json = {{"version", server::build_info().version}, {"format", settings.format}, {"session", *std::move(session)}};
  if (!settings.has_points()) return json;
  absl::StatusOr<Json> sample = to_json(requests->sample);
  if (!sample.ok()) return sample;
  json["sample"] = *std::move(sample);
  if (requests->scatters) json["sampler"] = sampler_of(settings.sampling.sample);
  json["cameras"] = settings.sampling.sample.cameras;
  json["first_answer"] = settings.sampling.first_answer;
  json["position_bits"] = settings.sampling.position_bits.value_or(0);
  json["normal_bits"] = settings.sampling.drc.normal_bits;
  json["splats"] = settings.sampling.splats;
  json["glb"] = settings.sampling.glb;
  return json;
}

void add_terms(const Json& settings, const client::UploadedMesh& mesh, Json* record) {
  Json companions = Json::object();
  for (const auto& [name, id] : mesh.companions) companions[name] = id;
  for (const std::string& name : mesh.missing) companions[name] = nullptr;
  (*record)[kSettings] = settings;
  (*record)[kCompanions] = std::move(companions);
}

absl::StatusOr<bool> has_terms(const Json& record, const std::string& mesh, const std::string& sha256, const Json& settings,
                               const std::stop_token& stop) {
  const Json found_sha256 = record.value("sha256", Json()), companions = record.value(kCompanions, Json());
  if (found_sha256 != sha256 || record.value(kSettings, Json()) != settings || !companions.is_object()) return false;
  for (const auto& [name, id] : companions.items()) {
    const absl::StatusOr<Json> now = companion_id(mesh, name, stop);
    if (!now.ok()) return now.status();
    if (*now != id) return false;
  }
  return true;
}

Json index_line(const Json& record) {
  Json line = record;
  line.erase(kSettings);
  line.erase(kCompanions);
  return line;
}

std::string to_lines(const std::vector<Json>& records) {
  std::string lines;
  for (const Json& record : records) lines += line_of(record);
  return lines;
}

}  // namespace curvecast::cli
