// Point sets as files: of a session, or straight on a mesh.
#pragma once

#include <memory>
#include <string>

#include "server/web/resources/point_file.h"
#include "server/web/resources/resource.h"

namespace curvecast::server {

/// GET: points of a session as a file of this kind, by Resample.
void get_points(const std::shared_ptr<WebResource>& resource, const std::string& session_id, const PointFileKind& kind);

/// GET: points on a mesh, of which there is no session, as a file of this kind, by Scatter.
void get_scattered_points(const std::shared_ptr<WebResource>& resource, const std::string& mesh_id, const PointFileKind& kind);

}  // namespace curvecast::server
