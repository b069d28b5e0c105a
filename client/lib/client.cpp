// SPDX-License-Identifier: Apache-2.0
#include "client/lib/client.h"

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <openssl/evp.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <set>
#include <thread>
#include <utility>

#include "client/lib/companion_files.h"
#include "client/lib/file_bytes.h"
#include "client/lib/point_blocks.h"
#include "client/lib/protocol.h"

namespace curvecast::client {
namespace {

constexpr std::size_t kHashBlock = 1 << 20;      // bytes read at a time
constexpr std::size_t kIdDigits = 32;            // of a mesh_id
constexpr int kReferenceRounds = 8;              // a mesh names material libraries, these name textures: two, as a rule
constexpr std::size_t kMostSessions = 100'000;   // that a server may list
constexpr std::size_t kMostMeshes = 10'000'000;  // the same
constexpr std::uint32_t kMeshesOnPage = 1000;

using Digest = std::array<unsigned char, SHA256_DIGEST_LENGTH>;

std::string to_hex(const Digest& digest) {
  return absl::BytesToHexString({reinterpret_cast<const char*>(digest.data()), digest.size()});
}

google::protobuf::Map<std::string, std::string> to_proto(const std::map<std::string, std::string>& companions) {
  return {companions.begin(), companions.end()};
}

void add_refused(const UploadedMesh& mesh, v1::MeshInfo* info) {
  for (const std::string& reason : mesh.refused) info->add_warnings(reason + ".");
}

/// What to do with the progress that a server tells.
OnProgress forward(const StageProgress& on_progress) {
  if (!on_progress) return {};
  return [&](const v1::Progress& progress) { on_progress(progress.stage(), progress.fraction()); };
}

/// Joins the pages of a list of at most `most` items, which are `what`: `call` is given a request for a page, `items` a page.
template <class Item, class Request, class Call, class Items>
absl::StatusOr<std::vector<Item>> read_pages(Request request, std::size_t most, const char* what, const Call& call,
                                             const Items& items) {
  std::vector<Item> list;
  do {
    const auto page = call(request);
    if (!page.ok()) return page.status();
    list.insert(list.end(), items(*page).begin(), items(*page).end());
    const bool is_new = page->next_page_token() != request.page_token() && list.size() < most;
    if (!page->next_page_token().empty() && !is_new) {
      return absl::DataLossError(absl::StrCat("the server's pages of ", what, " do not end"));
    }
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return list;
}

}  // namespace

std::string mesh_id_of(std::span<const char> bytes) {
  Digest digest;
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  return mesh_id_of_sha256(to_hex(digest));
}

std::string mesh_id_of_sha256(std::string_view sha256) { return std::string(sha256.substr(0, kIdDigits)); }

absl::StatusOr<std::string> sha256_of(const InputFile& file, const std::stop_token& stop) {
  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };
  const std::unique_ptr<EVP_MD_CTX, Free> context(EVP_MD_CTX_new());
  bool is_sound = context != nullptr && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  std::string block;
  for (std::uint64_t offset = 0; offset < file.size(); offset += block.size()) {
    if (stop.stop_requested()) return absl::CancelledError("cancelled");
    block.resize(std::min<std::uint64_t>(kHashBlock, file.size() - offset));
    if (absl::Status status = file.read_at(offset, block); !status.ok()) return status;
    is_sound = is_sound && EVP_DigestUpdate(context.get(), block.data(), block.size()) == 1;
  }
  Digest digest;
  is_sound = is_sound && EVP_DigestFinal_ex(context.get(), digest.data(), nullptr) == 1;
  if (!is_sound) return absl::ResourceExhaustedError("out of memory for hashing");
  return to_hex(digest);
}

absl::StatusOr<Health> Client::check_health(std::chrono::milliseconds timeout, std::stop_token stop) {
  return connection_->check_health(timeout, std::move(stop));
}

absl::StatusOr<std::string> Client::upload_mesh(const std::string& path, const StageProgress& on_progress, std::stop_token stop) {
  absl::StatusOr<InputFile> file = InputFile::open(path);
  if (!file.ok()) return file.status();
  return upload_file(*file, std::filesystem::path(path).filename().string(), on_progress, stop);
}

absl::StatusOr<std::string> Client::upload_file(const InputFile& file, const std::string& name, const StageProgress& on_progress,
                                                std::stop_token stop) {
  const absl::StatusOr<std::string> hash = sha256_of(file, stop);
  if (!hash.ok()) return hash.status();
  v1::UploadHeader header;
  header.set_name(name);
  header.set_size(file.size());
  header.set_mesh_id(mesh_id_of_sha256(*hash));
  return upload_if_missing(
      header, [&](std::uint64_t offset, std::span<char> out) { return file.read_at(offset, out); }, on_progress, stop);
}

absl::StatusOr<UploadedMesh> Client::upload_with_companions(const std::string& path, const StageProgress& on_progress,
                                                            std::stop_token stop) {
  absl::StatusOr<std::string> mesh_id = upload_mesh(path, on_progress, stop);
  if (!mesh_id.ok()) return mesh_id.status();
  UploadedMesh mesh(*std::move(mesh_id));
  if (!may_have_companions(path)) return mesh;
  std::set<std::string> seen;
  for (int round = 0; round < kReferenceRounds; ++round) {
    v1::ListMeshReferencesRequest request;
    request.set_mesh_id(mesh.mesh_id);
    *request.mutable_companions() = to_proto(mesh.companions);
    absl::StatusOr<v1::ListMeshReferencesResponse> references = connection_->list_mesh_references(request, stop);
    if (!references.ok()) return references.status();
    bool has_more = false;
    for (const std::string& name : references->missing()) {
      if (seen.size() >= kMaxCompanions) break;
      if (!seen.insert(name).second) continue;
      absl::StatusOr<InputFile> file = open_companion(path, name);
      if (!file.ok()) {
        mesh.missing.push_back(name);
        if (!absl::IsNotFound(file.status())) mesh.refused.emplace_back(file.status().message());
        continue;
      }
      absl::StatusOr<std::string> id = upload_file(*file, std::filesystem::path(name).filename().string(), on_progress, stop);
      if (!id.ok()) return id.status();
      mesh.companions[name] = *std::move(id);
      has_more = true;
    }
    if (!has_more) break;
  }
  return mesh;
}

absl::StatusOr<std::string> Client::upload_mesh(const std::string& name, std::span<const char> bytes,
                                                const StageProgress& on_progress, std::stop_token stop) {
  v1::UploadHeader header;
  header.set_name(name);
  header.set_size(bytes.size());
  header.set_mesh_id(mesh_id_of(bytes));
  const ReadAt read = [&](std::uint64_t offset, std::span<char> out) {
    std::memcpy(out.data(), bytes.data() + offset, out.size());
    return absl::OkStatus();
  };
  return upload_if_missing(header, read, on_progress, stop);
}

absl::StatusOr<std::string> Client::upload_if_missing(const v1::UploadHeader& header, const ReadAt& read,
                                                      const StageProgress& on_progress, std::stop_token stop) {
  v1::GetMeshRequest question;
  question.set_mesh_id(header.mesh_id());
  const absl::Status held = connection_->get_mesh(question, stop).status();
  if (held.ok()) return header.mesh_id();
  if (!absl::IsNotFound(held)) return held;
  const OnBytes on_bytes = [&](std::uint64_t sent) {
    if (on_progress) on_progress("upload", static_cast<double>(sent) / static_cast<double>(header.size()));
  };
  absl::StatusOr<v1::UploadMeshResponse> response = connection_->upload_mesh(header, read, on_bytes, stop);
  if (!response.ok()) return response.status();
  if (response->mesh_id() != header.mesh_id()) {
    return absl::DataLossError(absl::StrCat(header.name(), ": sent as mesh ", header.mesh_id(), ", but the server received mesh ",
                                            response->mesh_id(), "; send it again"));
  }
  return header.mesh_id();
}

absl::StatusOr<std::vector<v1::StoredMesh>> Client::list_meshes(std::stop_token stop) {
  v1::ListMeshesRequest first;
  first.set_page_size(kMeshesOnPage);
  return read_pages<v1::StoredMesh>(
      first, kMostMeshes, "meshes", [&](const v1::ListMeshesRequest& request) { return connection_->list_meshes(request, stop); },
      [](const v1::ListMeshesResponse& page) -> const auto& { return page.meshes(); });
}

absl::StatusOr<v1::MeshInfo> Client::inspect(const UploadedMesh& mesh, std::stop_token stop) {
  v1::InspectMeshRequest request;
  request.set_mesh_id(mesh.mesh_id);
  *request.mutable_companions() = to_proto(mesh.companions);
  absl::StatusOr<v1::InspectMeshResponse> response = connection_->inspect_mesh(request, stop);
  if (!response.ok()) return response.status();
  add_refused(mesh, response->mutable_mesh());
  return std::move(*response->mutable_mesh());
}

absl::StatusOr<v1::RenderResponse> Client::render(const v1::RenderRequest& request, std::stop_token stop) {
  return connection_->render(request, stop);
}

absl::StatusOr<ParameterMesh> Client::get_parameter_mesh(const UploadedMesh& mesh, const v1::SessionOptions& options,
                                                         std::stop_token stop) {
  v1::GetParameterMeshRequest request;
  request.set_mesh_id(mesh.mesh_id);
  request.mutable_companions()->insert(mesh.companions.begin(), mesh.companions.end());
  request.set_parameteriser(options.parameteriser());
  request.set_chart_faces(options.chart_faces());
  absl::StatusOr<std::vector<v1::GetParameterMeshResponse>> responses = connection_->get_parameter_mesh(request, std::move(stop));
  if (!responses.ok()) return responses.status();
  return decode_parameter_mesh(*responses);
}

absl::StatusOr<v1::Session> Client::create_session(const UploadedMesh& mesh, const v1::SessionOptions& options,
                                                   const StageProgress& on_progress, std::stop_token stop) {
  v1::CreateSessionRequest request;
  request.set_mesh_id(mesh.mesh_id);
  *request.mutable_companions() = to_proto(mesh.companions);
  *request.mutable_options() = options;
  request.set_without_preview(true);  // nobody could see it
  absl::StatusOr<v1::Session> session = connection_->create_session(request, forward(on_progress), stop);
  if (session.ok()) add_refused(mesh, session->mutable_report()->mutable_mesh());
  return session;
}

absl::StatusOr<v1::Session> Client::get_session(const std::string& session_id, std::stop_token stop) {
  v1::GetSessionRequest request;
  request.set_session_id(session_id);
  absl::StatusOr<v1::GetSessionResponse> response = connection_->get_session(request, stop);
  if (!response.ok()) return response.status();
  return std::move(*response->mutable_session());
}

absl::StatusOr<std::vector<v1::Session>> Client::list_sessions(std::stop_token stop) {
  return read_pages<v1::Session>(
      v1::ListSessionsRequest(), kMostSessions, "sessions",
      [&](const v1::ListSessionsRequest& request) { return connection_->list_sessions(request, stop); },
      [](const v1::ListSessionsResponse& page) -> const auto& { return page.sessions(); });
}

absl::StatusOr<v1::Session> Client::update_session(const v1::UpdateSessionRequest& request, std::stop_token stop) {
  absl::StatusOr<v1::UpdateSessionResponse> response = connection_->update_session(request, std::move(stop));
  if (!response.ok()) return response.status();
  return std::move(*response->mutable_session());
}

absl::Status Client::close_session(const std::string& session_id, std::stop_token stop) {
  v1::CloseSessionRequest request;
  request.set_session_id(session_id);
  return connection_->close_session(request, stop);
}

absl::StatusOr<Curve> Client::get_curve(const std::string& session_id, std::stop_token stop) {
  v1::GetCurveRequest request;
  request.set_session_id(session_id);
  absl::StatusOr<std::vector<v1::GetCurveResponse>> responses = connection_->get_curve(request, std::move(stop));
  if (!responses.ok()) return responses.status();
  return decode_curve(*responses);
}

absl::StatusOr<Surface> Client::get_surface(const v1::GetSurfaceRequest& request, std::stop_token stop) {
  const absl::StatusOr<std::vector<v1::GetSurfaceResponse>> responses = connection_->get_surface(request, std::move(stop));
  if (!responses.ok()) return responses.status();
  return join_surface(*responses);
}

absl::StatusOr<EncodedSample> Client::resample_encoded(const v1::ResampleRequest& request, std::stop_token stop) {
  absl::StatusOr<std::vector<v1::ResampleResponse>> responses = connection_->resample(request, stop);
  if (!responses.ok()) return responses.status();
  SampleGatherer gatherer;
  for (v1::ResampleResponse& response : *responses) gatherer.add(response);
  return std::move(gatherer).take(request.sample());
}

absl::StatusOr<ScatteredSample> Client::scatter(const UploadedMesh& mesh, v1::ScatterRequest request,
                                                const StageProgress& on_progress, std::stop_token stop) {
  request.set_mesh_id(mesh.mesh_id);
  *request.mutable_companions() = to_proto(mesh.companions);
  absl::StatusOr<std::vector<v1::ScatterResponse>> responses = connection_->scatter(request, forward(on_progress), stop);
  if (!responses.ok()) return responses.status();
  ScatteredSample out;
  SampleGatherer gatherer;
  for (v1::ScatterResponse& response : *responses) {
    if (response.has_mesh()) out.mesh = std::move(*response.mutable_mesh());
    if (response.has_points()) gatherer.add(*response.mutable_points());
  }
  const absl::StatusOr<EncodedSample> encoded = std::move(gatherer).take(request.sample());
  if (!encoded.ok()) return encoded.status();
  absl::StatusOr<DecodedSample> decoded = decode_sample(*encoded);
  if (!decoded.ok()) return decoded.status();
  out.sample = *std::move(decoded);
  add_refused(mesh, &out.mesh);
  return out;
}

absl::StatusOr<DecodedSample> Client::resample(const v1::ResampleRequest& request, std::stop_token stop) {
  absl::StatusOr<EncodedSample> sample = resample_encoded(request, stop);
  if (!sample.ok()) return sample.status();
  return decode_sample(*sample);
}

absl::StatusOr<DecodedSample> Client::resample_refined(const v1::ResampleRequest& request, std::chrono::milliseconds patience,
                                                       std::stop_token stop) {
  constexpr int kRounds = 4;  // a density may find the finer curve too coarse again
  constexpr std::chrono::milliseconds kPoll{20};
  const auto deadline = std::chrono::steady_clock::now() + patience;
  absl::StatusOr<DecodedSample> sample = resample(request, stop);
  for (int round = 0; round < kRounds && sample.ok() && sample->statistics.refining(); ++round) {
    while (true) {
      absl::StatusOr<v1::Session> session = get_session(request.session_id(), stop);
      if (!session.ok()) return session.status();
      if (!session->refining()) break;
      if (std::chrono::steady_clock::now() >= deadline) return sample;
      std::this_thread::sleep_for(kPoll);
    }
    sample = resample(request, stop);
  }
  return sample;
}

absl::StatusOr<Neighbours> Client::find_neighbours(const v1::FindNeighboursRequest& request, const StageProgress& on_progress,
                                                   std::stop_token stop) {
  const auto responses = connection_->find_neighbours(request, forward(on_progress), std::move(stop));
  if (!responses.ok()) return responses.status();
  return decode_neighbours(*responses, request);
}

absl::StatusOr<Mesh> Client::remesh(const v1::RemeshRequest& request, const StageProgress& on_progress, std::stop_token stop) {
  const absl::StatusOr<std::vector<v1::RemeshResponse>> responses = connection_->remesh(request, forward(on_progress), stop);
  if (!responses.ok()) return responses.status();
  absl::StatusOr<Mesh> mesh = decode_mesh(*responses);
  if (mesh.ok() && request.sample().has_points() && mesh->vertices.size() > request.sample().points()) {
    return absl::DataLossError(absl::StrCat("asked for a mesh of ", request.sample().points(), " vertices, but the server sent ",
                                            mesh->vertices.size()));
  }
  return mesh;
}

absl::StatusOr<v1::Measures> Client::measure(const UploadedMesh& mesh, std::span<const Points> sets, v1::MeasureRequest request,
                                             const StageProgress& on_progress, std::stop_token stop) {
  static_assert(std::endian::native == std::endian::little);
  request.set_mesh_id(mesh.mesh_id);
  *request.mutable_companions() = to_proto(mesh.companions);
  for (const Points& set : sets) {
    const std::span<const char> bytes(reinterpret_cast<const char*>(set.positions.data()),
                                      set.positions.size() * sizeof set.positions[0]);
    absl::StatusOr<std::string> id = upload_mesh("points", bytes, on_progress, stop);
    if (!id.ok()) return id.status();
    v1::UploadedPoints& points = *request.add_sets();
    points.set_points_id(*std::move(id));
    points.mutable_origin()->set_x(set.origin[0]);
    points.mutable_origin()->set_y(set.origin[1]);
    points.mutable_origin()->set_z(set.origin[2]);
  }
  absl::StatusOr<v1::Measures> measures = connection_->measure(request, forward(on_progress), stop);
  if (!measures.ok()) return measures;
  if (measures->sets_size() != request.sets_size()) {
    return absl::DataLossError(
        absl::StrCat("asked for the measures of ", request.sets_size(), " sets, but the server sent ", measures->sets_size()));
  }
  return measures;
}

}  // namespace curvecast::client
