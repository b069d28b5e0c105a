// What the server says about meshes and sessions, as JSON and as text.
#pragma once

#include <string>

#include "client/cli/common.h"
#include "core/base/vec.h"

namespace curvecast::cli {

Json mesh_json(const v1::MeshInfo& mesh);       // {vertices, faces, components, genus, boundary_loops}
Json repairs_json(const v1::Repairs& repairs);  // one count each
Json strings_json(const google::protobuf::RepeatedPtrField<std::string>& strings);
Json preprocess_json(const v1::Session& session);

std::string mesh_text(const v1::MeshInfo& mesh);  // a few lines, and one for each warning
std::string preprocess_text(const v1::Session& session);

Box3d box_of(const v1::MeshInfo& mesh);

}  // namespace curvecast::cli
