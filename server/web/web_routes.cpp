#include "server/web/web_routes.h"

#include <absl/strings/str_cat.h>

#include <utility>

namespace curvecast::server {
namespace {

constexpr char kIndex[] = "/index.html";
// Everything comes from this server, whatever a page is made to say. WebAssembly decodes Draco.
constexpr char kContentPolicy[] =
    "; default-src 'self'; worker-src 'self' blob:; connect-src 'self'; frame-ancestors "
    "'self'; "
    "img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; base-uri 'none'; form-action 'none'";

WebAnswer to_answer(const WebFile& file) {
  const std::string scripts = absl::StrCat("script-src 'self' 'wasm-unsafe-eval'", file.scripts.empty() ? "" : " ",
                                           absl::string_view(file.scripts.data(), file.scripts.size()));
  return {.body = std::string(file.gzip),
          .type = std::string(file.type),
          .header = {{"Content-Encoding", "gzip"},
                     {"Cache-Control", file.is_immutable ? "public, max-age=31536000, immutable" : "no-cache"},
                     {"Content-Security-Policy", scripts + kContentPolicy},
                     {"Referrer-Policy", "no-referrer"}}};
}

/// What a probe is told: `good`, or what is wrong.
std::function<WebAnswer()> probe(std::function<std::string()> wrong, std::string good) {
  return [wrong = std::move(wrong), good = std::move(good)] {
    const std::string reason = wrong();
    return reason.empty() ? WebAnswer{.body = good + "\n"} : WebAnswer{.status = 503, .body = reason + "\n"};
  };
}

}  // namespace

WebRoutes page_routes(std::span<const WebFile> files) {
  WebRoutes routes;
  routes["/"] = [] { return WebAnswer{.status = 404, .body = "this server was built without the viewer\n"}; };
  for (const WebFile& file : files) {
    const auto answer = [file] { return to_answer(file); };
    routes[std::string(file.path)] = answer;
    if (file.path == kIndex) routes["/"] = answer;
  }
  return routes;
}

WebRoutes probe_routes(const WebHealth& health) {
  return {{"/healthz", probe(health.dead, "alive")}, {"/readyz", probe(health.unready, "ready")}};
}

WebRoutes metrics_routes(Engine& engine) {
  return {{"/metrics", [&engine] {
             return WebAnswer{.body = engine.metrics.text(engine.gauges()), .type = "text/plain; version=0.0.4; charset=utf-8"};
           }}};
}

}  // namespace curvecast::server
