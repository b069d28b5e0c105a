// Meshes as resources.
#pragma once

#include <memory>
#include <string>

#include "server/web/resources/resource.h"

namespace curvecast::server {

/// GET: a page of them, as ListMeshes.
void list_meshes(const std::shared_ptr<WebResource>& resource);
/// PUT: uploads the body, however long it turns out to be, as a file of this name, and inspects it unless the query says
/// inspect=false. Its part mesh_id is the hash that the client expects.
void put_mesh(const std::shared_ptr<WebResource>& resource, const std::string& name);
/// GET: what GetMesh says.
void get_mesh(const std::shared_ptr<WebResource>& resource, const std::string& id);

}  // namespace curvecast::server
