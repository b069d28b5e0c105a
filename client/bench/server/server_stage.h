// What benchmarks of streams begin with: a server in a process of its own, with a session of one mesh.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <string>

#include "client/bench/server/server_process.h"
#include "client/lib/client.h"
#include "client/lib/view_stream.h"
#include "core/base/execution_context.h"
#include "core/base/vec.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

class ServerStage {
 public:
  /// Starts a server (see ServerProcess), sends it the mesh, and waits for a session for so many points. Errors as of the client
  /// library.
  static absl::StatusOr<ServerStage> open(const MeshFile& file, std::uint64_t points, const std::string& command,
                                          const ExecutionContext& context);

  /// Connects over TCP; no two connections are one.
  std::shared_ptr<client::Connection> connect() const;
  const std::string& session_id() const { return session_id_; }
  const ServerProcess& server() const { return *server_; }
  /// Returns the mesh's box.
  const Box3d& box() const { return box_; }

 private:
  std::unique_ptr<ServerProcess> server_;
  std::string session_id_;
  Box3d box_;
};

/// Sends a view and waits for its first frame or, `settled`, for its last one. A view that the server refuses is an error.
absl::StatusOr<client::Frame> answer(client::ViewStream& stream, const v1::SampleRequest& sample, bool settled);

}  // namespace curvecast::cli::bench
