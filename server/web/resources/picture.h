// Pictures of a session.
#pragma once

#include <memory>
#include <string>

#include "server/web/resources/resource.h"

namespace curvecast::server {

/// GET: a picture of this format, by Render.
void get_picture(const std::shared_ptr<WebResource>& resource, const std::string& session_id, v1::PictureFormat format);

}  // namespace curvecast::server
