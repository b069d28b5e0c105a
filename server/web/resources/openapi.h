// The description of the resources, for programs that make clients: OpenAPI 3.1.
#pragma once

#include <string_view>

namespace curvecast::server {

/// openapi.json.
extern const std::string_view kOpenApi;

}  // namespace curvecast::server
