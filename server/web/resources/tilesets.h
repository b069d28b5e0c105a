// Points of a session as 3D Tiles, which viewers load by what they look at.
#pragma once

#include <memory>
#include <string>

#include "server/web/resources/resource.h"
#include "server/web/resources/tileset_jobs.h"

namespace curvecast::server {

/// GET: the file that names all tiles, by addresses relative to its own. Its points come by Resample.
void get_tileset(const std::shared_ptr<WebResource>& resource, const std::shared_ptr<TilesetJobs>& jobs,
                 const std::string& session_id);

/// GET: one tile, or the description of those below one. `part`: of the address, as of TilesetAddress. The query means nothing:
/// some viewers repeat that of the tileset.
void get_tile(const std::shared_ptr<WebResource>& resource, const std::shared_ptr<TilesetJobs>& jobs,
              const std::string& session_id, const std::string& part, const std::string& name);

}  // namespace curvecast::server
