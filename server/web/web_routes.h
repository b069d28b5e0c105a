// What the HTTP port answers.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "server/base/web_file.h"
#include "server/engine/engine.h"
#include "server/web/web_gateway.h"

namespace curvecast::server {

/// /healthz, /readyz, /metrics and the files, of which "/index.html" is "/" too. `unready`: why nobody should send requests now;
/// empty where all may. `engine` must outlive the routes.
WebRoutes make_web_routes(Engine& engine, std::function<std::string()> unready, std::span<const WebFile> files);

}  // namespace curvecast::server
