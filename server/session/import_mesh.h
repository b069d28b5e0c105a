// Takes meshes from the one folder of the server's machine that it offers.
#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <string>

#include "core/base/execution_context.h"
#include "server/session/mesh_store.h"

namespace curvecast::server {

/// Stores the file at `path`, relative to `folder`, as if the client had sent it. NotFound: there is no such file.
/// PermissionDenied: `folder` is empty, or the path leads out of it, be it through a link. Other errors as of MeshUpload.
absl::StatusOr<std::shared_ptr<const Mesh>> import_mesh(MeshStore& store, const Maker& maker, const std::string& folder,
                                                        const std::string& path, const ExecutionContext& context);

}  // namespace curvecast::server
