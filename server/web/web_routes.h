// The answers of the HTTP port, by path.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "server/base/web_file.h"
#include "server/engine/engine.h"
#include "server/web/web_gateway.h"

namespace curvecast::server {

/// What is wrong, empty where nothing is. Called by any thread, and returns at once.
struct WebHealth {
  std::function<std::string()> dead;     // why the server had better be started anew
  std::function<std::string()> unready;  // why nobody should send requests now
};

/// Makes the routes /healthz, /readyz, /metrics and those of the files, of which "/index.html" is "/" too. `engine` must outlive
/// the routes.
WebRoutes make_web_routes(Engine& engine, const WebHealth& health, std::span<const WebFile> files);

}  // namespace curvecast::server
