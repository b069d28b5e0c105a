// SPDX-License-Identifier: Apache-2.0
// What a program does with a Curvecast server: bring a mesh, open a session, take point sets.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "connection.h"
#include "curve.h"
#include "curvecast/v1/curvecast.pb.h"
#include "encoded_sample.h"
#include "mesh.h"
#include "neighbours.h"
#include "parameter_mesh.h"

namespace curvecast::client {

class InputFile;

/// `stage` is "upload" or one of v1::Progress.stage; `fraction` of the stage, 0 to 1. Called from the calling thread.
using StageProgress = std::function<void(std::string_view stage, double fraction)>;

/// A mesh that the server holds, with what it refers to. A mesh_id alone is one without companions.
struct UploadedMesh {
  UploadedMesh(std::string id = {}) : mesh_id(std::move(id)) {}  // NOLINT(google-explicit-constructor): stands for the id

  std::string mesh_id;
  std::map<std::string, std::string> companions;  // name in the mesh -> mesh_id of that file
  std::vector<std::string> missing;               // names of other files in the mesh, which were not sent
  std::vector<std::string> refused;               // why some of these were not, though they may be there
};

struct ScatteredSample {
  DecodedSample sample;
  v1::MeshInfo mesh;  // that the points lie on
};

/// The 32 hexadecimal digits by which servers know a mesh file: the first half of SHA-256 of its bytes.
std::string mesh_id_of(std::span<const char> bytes);
/// SHA-256 of a file, 64 hexadecimal digits, of which the first 32 are the id. Cancelled; errors of InputFile::read_at.
absl::StatusOr<std::string> sha256_of(const InputFile& file, const std::stop_token& stop = {});
/// The id of a file with this SHA-256.
std::string mesh_id_of_sha256(std::string_view sha256);

/// Thread-safe. Every call blocks, and returns Cancelled soon after `stop` is requested. Errors are those of the API, see the
/// .proto file, and of Connection; DataLoss when the server's answer makes no sense.
class Client {
 public:
  explicit Client(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}

  /// What a probe asks; at most for `timeout`. See Connection::check_health().
  absl::StatusOr<Health> check_health(std::chrono::milliseconds timeout, std::stop_token stop = {});

  /// Makes the server hold a mesh file, sent only if it does not yet, and returns its mesh_id. The file is read twice (hash,
  /// upload) and never held in memory. NotFound, PermissionDenied or InvalidArgument name a file that cannot be read.
  absl::StatusOr<std::string> upload_mesh(const std::string& path, const StageProgress& on_progress = {},
                                          std::stop_token stop = {});
  /// The same for bytes in memory; `name` as of a file.
  absl::StatusOr<std::string> upload_mesh(const std::string& name, std::span<const char> bytes,
                                          const StageProgress& on_progress = {}, std::stop_token stop = {});
  /// upload_mesh() of a file and, where its format can refer to others, of those that it refers to and that lie in its own
  /// folder (see open_companion; no other file is read, whatever mesh and server say). Those that are missing are left out, and
  /// MeshInfo.warnings names them; inspect() and create_session() add there why the client refused any. At most 256 files, in 8
  /// rounds of references to references.
  absl::StatusOr<UploadedMesh> upload_with_companions(const std::string& path, const StageProgress& on_progress = {},
                                                      std::stop_token stop = {});
  /// The files of this caller that the server holds, by mesh_id: see ListMeshes. All pages.
  absl::StatusOr<std::vector<v1::StoredMesh>> list_meshes(std::stop_token stop = {});
  absl::StatusOr<v1::MeshInfo> inspect(const UploadedMesh& mesh, std::stop_token stop = {});

  /// The parameter mesh of sessions with these options, of which the parameteriser and the size of charts count. Checked: see
  /// decode_parameter_mesh. Computed anew by the server for every call.
  absl::StatusOr<ParameterMesh> get_parameter_mesh(const UploadedMesh& mesh, const v1::SessionOptions& options,
                                                   std::stop_token stop = {});

  /// Waits until the session is ready. Requesting stop ends the preprocessing unless other clients wait for it too.
  absl::StatusOr<v1::Session> create_session(const UploadedMesh& mesh, const v1::SessionOptions& options,
                                             const StageProgress& on_progress = {}, std::stop_token stop = {});
  absl::StatusOr<v1::Session> get_session(const std::string& session_id, std::stop_token stop = {});
  absl::StatusOr<std::vector<v1::Session>> list_sessions(std::stop_token stop = {});  // all pages
  absl::StatusOr<v1::Session> update_session(const v1::UpdateSessionRequest& request, std::stop_token stop = {});
  absl::Status close_session(const std::string& session_id, std::stop_token stop = {});

  /// The curve of a ready session, checked: see decode_curve.
  absl::StatusOr<Curve> get_curve(const std::string& session_id, std::stop_token stop = {});

  absl::StatusOr<DecodedSample> resample(const v1::ResampleRequest& request, std::stop_token stop = {});
  /// The best that the session can give: while the answer says that the curve is being refined for it, waits for that, at most
  /// `patience` in all, and asks again. What it has then counts.
  absl::StatusOr<DecodedSample> resample_refined(const v1::ResampleRequest& request, std::chrono::milliseconds patience,
                                                 std::stop_token stop = {});
  absl::StatusOr<EncodedSample> resample_encoded(const v1::ResampleRequest& request, std::stop_token stop = {});

  /// Points straight on a mesh, without a session: see Scatter. `request`: all but the mesh.
  absl::StatusOr<ScatteredSample> scatter(const UploadedMesh& mesh, v1::ScatterRequest request,
                                          const StageProgress& on_progress = {}, std::stop_token stop = {});

  /// The neighbours of each of the points that the request asks for, checked: see decode_neighbours.
  absl::StatusOr<Neighbours> find_neighbours(const v1::FindNeighboursRequest& request, const StageProgress& on_progress = {},
                                             std::stop_token stop = {});

  /// A triangle mesh of the points that the request asks for, checked: see decode_mesh.
  absl::StatusOr<Mesh> remesh(const v1::RemeshRequest& request, const StageProgress& on_progress = {}, std::stop_token stop = {});

  /// The triangles themselves: see join_surface.
  absl::StatusOr<Surface> get_surface(const v1::GetSurfaceRequest& request, std::stop_token stop = {});

  /// A picture that the server draws.
  absl::StatusOr<v1::RenderResponse> render(const v1::RenderRequest& request, std::stop_token stop = {});

  /// Sends what the server does not hold yet of the sets, and has them measured on the mesh. `request`: all but mesh and sets.
  absl::StatusOr<v1::Measures> measure(const UploadedMesh& mesh, std::span<const Points> sets, v1::MeasureRequest request,
                                       const StageProgress& on_progress = {}, std::stop_token stop = {});

  const std::shared_ptr<Connection>& connection() const { return connection_; }

 private:
  absl::StatusOr<std::string> upload_file(const InputFile& file, const std::string& name, const StageProgress& on_progress,
                                          std::stop_token stop);
  absl::StatusOr<std::string> upload_if_missing(const v1::UploadHeader& header, const ReadAt& read,
                                                const StageProgress& on_progress, std::stop_token stop);

  std::shared_ptr<Connection> connection_;
};

}  // namespace curvecast::client
