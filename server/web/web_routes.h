// The answers of the HTTP port, by path.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "server/base/web_file.h"
#include "server/engine/engine.h"
#include "server/web/web_gateway.h"

namespace curvecast::server {

/// Makes the routes /healthz, /readyz, /metrics and those of the files, of which "/index.html" is "/" too. `unready` returns why
/// nobody should send requests now; empty where all may. `engine` must outlive the routes.
WebRoutes make_web_routes(Engine& engine, std::function<std::string()> unready, std::span<const WebFile> files);

}  // namespace curvecast::server
