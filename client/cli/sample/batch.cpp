#include "client/cli/sample/batch.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/strip.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "client/cli/exit_status.h"
#include "client/cli/progress_bar.h"
#include "client/cli/report.h"
#include "client/cli/sample/batch_record.h"
#include "client/lib/file_bytes.h"
#include "server/session/cache_folder.h"

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

// With the refinement of a curve: points must not depend on how fast a machine is.
constexpr std::chrono::hours kPatience{24 * 365};

/// Whether every other mesh would fare the same.
bool ends_run(const absl::Status& status) {
  return absl::IsCancelled(status) || absl::IsUnavailable(status) || absl::IsUnauthenticated(status) ||
         absl::IsPermissionDenied(status);
}

bool is_ours(absl::StatusCode code) { return exit_status(absl::Status(code, ""), false) == kServerError; }

/// The status with the mesh's path before it, once: servers know its file's name alone.
absl::Status of_mesh(const PlannedMesh& mesh, const absl::Status& status) {
  absl::string_view message = status.message();
  if (!absl::ConsumePrefix(&message, mesh.path + ": ")) {
    absl::ConsumePrefix(&message, fs::path(mesh.path).filename().string() + ": ");
  }
  return absl::Status(status.code(), absl::StrCat(mesh.mesh, ": ", message));
}

Json line_of(const PlannedMesh& mesh) { return {{"mesh", mesh.mesh}, {"name", mesh.name}}; }

std::string made_text(const std::string& title, const Json& record) {
  const std::string points = record.contains("points") ? absl::StrCat(record["points"].get<std::uint64_t>(), " points, ") : "";
  return absl::StrFormat("%s: %s%.2f s", title, points, record["seconds"].get<double>());
}

}  // namespace

SessionCaching Batch::caching() const { return common_.cache.empty() ? SessionCaching::kNone : SessionCaching::kKeepAll; }

bool Batch::is_cached(const std::string& session_id) const {
  return server::is_content_id(session_id) && server::is_file(server::CacheFolder(common_.cache).curve_path(session_id));
}

absl::StatusOr<Batch::Wanted> Batch::look_at(const PlannedMesh& mesh, const std::stop_token& stop) {
  absl::StatusOr<BatchSettings> settings = entries_.of(mesh.arguments);
  if (!settings.ok()) return settings.status();
  absl::StatusOr<Json> json = settings_json(*settings);
  if (!json.ok()) return json.status();
  const absl::StatusOr<client::InputFile> file = client::InputFile::open(mesh.path);
  if (!file.ok()) return file.status();
  absl::StatusOr<std::string> sha256 = client::sha256_of(*file, stop);
  if (!sha256.ok()) return sha256.status();
  return Wanted{*std::move(settings), *std::move(json), *std::move(sha256)};
}

absl::StatusOr<bool> Batch::is_current(const PlannedMesh& mesh, const Wanted& wanted, const Json& record,
                                       const std::stop_token& stop) const {
  const absl::StatusOr<bool> is_of_it = has_terms(record, mesh.path, wanted.sha256, wanted.settings_json, stop);
  if (!is_of_it.ok() || !*is_of_it) return is_of_it;
  if (!mesh.output.empty()) {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path_of(mesh.output), error);
    if (error || record.value("bytes", Json()) != bytes) return false;
  }
  const Json session = record.value("session_id", Json());
  return common_.cache.empty() || scatters(wanted.settings.sampling.sample) ||
         (session.is_string() && is_cached(session.get<std::string>()));
}

absl::StatusOr<Batch::Made> Batch::make(const PlannedMesh& mesh, const Wanted& wanted, const std::string& title,
                                        const std::stop_token& stop) const {
  const Clock::time_point start = Clock::now();
  const SamplingFlags& flags = wanted.settings.sampling;
  const absl::StatusOr<SamplingRequests> requests = make_sampling_requests(flags, wanted.settings.seed, mesh.output);
  if (!requests.ok()) return requests.status();
  ProgressBar bar(progress_style(common_.quiet) == ProgressStyle::kBar ? ProgressStyle::kBar : ProgressStyle::kNone, title);
  const client::StageProgress on_progress = [&](std::string_view stage, double fraction) { bar.update(stage, fraction); };
  // A server for each mesh: no mesh leaves anything behind that takes memory, or changes the points of another one.
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(common_, requests->scatters ? SessionCaching::kNone : caching());
  if (!host.ok()) return host.status();
  absl::StatusOr<SampledMesh> sampled = requests->scatters
                                            ? scatter_on((*host)->client(), mesh.path, *requests, flags, on_progress, stop)
                                            : sample_prepared(mesh, wanted, *requests, *host, on_progress, stop);
  if (!sampled.ok()) return sampled.status();
  bar.finish();
  if (sampled->opened.mesh.mesh_id != client::mesh_id_of_sha256(wanted.sha256)) {
    return absl::FailedPreconditionError("the file was changed while it was read");
  }
  Made made{.record = line_of(mesh), .points = std::move(sampled->sample.points)};
  made.record["sha256"] = wanted.sha256;
  if (!requests->scatters) made.record["session_id"] = sampled->opened.session.session_id();
  if (wanted.settings.has_points()) {
    const std::string limit = point_limit_text(made.points.size(), sampled->sample.statistics);
    if (!limit.empty() && !common_.quiet) print_note(absl::StrCat(mesh.mesh, ": ", limit));
    made.record["output"] = mesh.output;
    made.record["points"] = made.points.size();
  }
  host->reset();  // which brings the session to the cache
  made.record["seconds"] = std::chrono::duration<double>(Clock::now() - start).count();
  add_terms(wanted.settings_json, sampled->opened.mesh, &made.record);
  return made;
}

absl::StatusOr<SampledMesh> Batch::sample_prepared(const PlannedMesh& mesh, const Wanted& wanted,
                                                   const SamplingRequests& requests, std::unique_ptr<Host>& host,
                                                   const client::StageProgress& on_progress, const std::stop_token& stop) const {
  absl::StatusOr<OpenedMesh> opened = open_mesh(host->client(), mesh.path, requests.session, on_progress, stop);
  if (!opened.ok()) return opened.status();
  SampledMesh out;
  if (wanted.settings.has_points()) {
    if (caching() == SessionCaching::kKeepAll && opened->session.curve_revision() > 1) {
      // Its curve was refined for other points, and would give others than a curve of this mesh's own.
      host.reset();
      absl::StatusOr<std::unique_ptr<Host>> other = Host::open(common_, SessionCaching::kNone);
      if (!other.ok()) return other.status();
      host = *std::move(other);
      opened = open_mesh(host->client(), mesh.path, requests.session, on_progress, stop);
      if (!opened.ok()) return opened.status();
    }
    absl::StatusOr<client::DecodedSample> sample =
        sample_session(host->client(), opened->session, wanted.settings.sampling, requests.sample, kPatience, stop);
    if (!sample.ok()) return sample.status();
    out.sample = *std::move(sample);
  }
  out.opened = *std::move(opened);
  return out;
}

absl::Status Batch::save(const PlannedMesh& mesh, const SamplingFlags& flags, Made& made) const {
  if (!common_.cache.empty() && made.record.contains("session_id") && !is_cached(made.record["session_id"].get<std::string>())) {
    return absl::ResourceExhaustedError(absl::StrCat(common_.cache, ": a session could not be saved; is the disk full?"));
  }
  if (!mesh.output.empty()) {
    const std::string path = path_of(mesh.output);
    if (absl::Status status = save_sample(path, made.points, flags); !status.ok()) return status;
    std::error_code error;
    made.record["bytes"] = fs::file_size(path, error);
  }
  return write_record(path_of(mesh.record), made.record);
}

absl::StatusOr<bool> Batch::note_failure(const PlannedMesh& mesh, std::size_t position, const absl::Status& status) {
  const absl::Status failure = of_mesh(mesh, status);
  if (ends_run(failure)) return failure;
  ++tally_.failed;
  if (!is_ours(tally_.worst)) tally_.worst = failure.code();
  lines_[position] = line_of(mesh);
  lines_[position]["error"] = std::string(failure.message());
  if (batch_.fail_fast) return failure;
  std::fprintf(stderr, "curvecast: %s\n", std::string(failure.message()).c_str());
  return true;
}

void Batch::note_done(std::size_t position, const Json& record) {
  lines_[position] = index_line(record);
  const Json points = record.value("points", Json());
  if (points.is_number_unsigned()) tally_.points += points.get<std::uint64_t>();
}

absl::StatusOr<bool> Batch::work_on(const PlannedMesh& mesh, std::size_t position, Turn turn, const std::stop_token& stop) {
  const std::string record_path = path_of(mesh.record);
  const std::optional<Json> record = read_record(record_path);
  if (record && is_of_making(*record) && turn == Turn::kFirst) return false;
  const absl::StatusOr<Wanted> wanted = look_at(mesh, stop);
  const absl::StatusOr<bool> is_there = wanted.ok() && record ? is_current(mesh, *wanted, *record, stop) : false;
  for (const absl::Status& status : {wanted.status(), is_there.status()}) {
    if (!status.ok()) return note_failure(mesh, position, status);
  }
  if (*is_there) {
    ++tally_.kept;
    note_done(position, *record);
    return true;
  }
  if (absl::Status status = make_folder(fs::path(record_path).parent_path().string()); !status.ok()) return status;
  if (absl::Status status = write_record(record_path, record_of_making(mesh)); !status.ok()) return status;
  const std::string title = absl::StrFormat("[%d/%d] %s", position + 1, lines_.size(), mesh.name);
  absl::StatusOr<Made> made = make(mesh, *wanted, title, stop);
  const absl::Status saved = made.ok() ? save(mesh, wanted->settings.sampling, *made) : absl::OkStatus();
  if (!made.ok() || !saved.ok()) {
    std::error_code ignored;
    fs::remove(record_path, ignored);
    if (!saved.ok()) return saved;
    return note_failure(mesh, position, made.status());
  }
  ++tally_.made;
  note_done(position, made->record);
  if (!common_.quiet) std::fprintf(stderr, "%s\n", made_text(title, made->record).c_str());
  return true;
}

absl::Status Batch::run(const std::vector<PlannedMesh>& plan, const std::stop_token& stop) {
  std::vector<const PlannedMesh*> meshes;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    if (batch_.shard.holds(i)) meshes.push_back(&plan[i]);
  }
  // A folder that cannot be used, or no way to the server, is no mesh's fault.
  if (absl::Status status = Host::open(common_, caching()).status(); !status.ok()) return status;
  lines_.assign(meshes.size(), Json());
  tally_ = {.meshes = meshes.size()};
  std::vector<std::size_t> turn_of(meshes.size());
  std::iota(turn_of.begin(), turn_of.end(), std::size_t{0});
  // One by which the process was ended before comes last, so that it does not keep the others waiting for ever.
  for (const Turn turn : {Turn::kFirst, Turn::kLast}) {
    std::vector<std::size_t> left;
    for (const std::size_t position : turn_of) {
      if (stop.stop_requested()) return absl::CancelledError("cancelled");
      const absl::StatusOr<bool> is_done = work_on(*meshes[position], position, turn, stop);
      if (!is_done.ok()) return is_done.status();
      if (!*is_done) left.push_back(position);
    }
    turn_of = std::move(left);
  }
  return absl::OkStatus();
}

}  // namespace curvecast::cli
