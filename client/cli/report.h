// What the server says about meshes, sessions and answers, as JSON and as text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/cli/common.h"
#include "core/base/vec.h"

namespace curvecast::cli {

Json mesh_json(const v1::MeshInfo& mesh);       // {vertices, faces, components, genus, boundary_loops, crease_degrees}
Json repairs_json(const v1::Repairs& repairs);  // one count each
Json strings_json(const google::protobuf::RepeatedPtrField<std::string>& strings);
Json preprocess_json(const v1::Session& session);

std::string mesh_text(const v1::MeshInfo& mesh);  // a few lines, and one for each warning
std::string preprocess_text(const v1::Session& session);

/// Returns such as "4,384 of 50,000 points: the view has no more places for points"; nothing where there are as many as wanted,
/// or as a budget in bytes holds.
std::string point_limit_text(std::uint64_t points, const v1::FrameStatistics& statistics);
/// Returns a word for the limit: "none", "bytes", "density", "server", "coming".
const char* point_limit_name(v1::PointLimit limit);
/// Prints a line to standard error.
void print_note(const std::string& text);

Box3d box_of(const v1::MeshInfo& mesh);
/// The angle at which the session's faces meet at a crease, as SessionOptions has it.
double crease_degrees(const v1::Session& session);

/// A quantile of measurements, by the nearest rank; 0 of none.
double quantile(std::vector<double> values, double q);

}  // namespace curvecast::cli
