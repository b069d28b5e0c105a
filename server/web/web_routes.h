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

/// Those of the files, of which "/index.html" is "/" too.
WebRoutes page_routes(std::span<const WebFile> files);
/// /healthz and /readyz.
WebRoutes probe_routes(const WebHealth& health);
/// /metrics. `engine` must outlive them.
WebRoutes metrics_routes(Engine& engine);

}  // namespace curvecast::server
