// How long great jobs will take, roughly: short ones go first.
#pragma once

#include <chrono>
#include <cstdint>

#include "core/pipeline/pipeline.h"

namespace curvecast {
struct MeshScatter;
}

namespace curvecast::server {

/// Returns about how long a session takes to be made on two cores, of a mesh file of so many bytes. The order of jobs hangs on
/// it, and when one counts as overdue; no more.
std::chrono::nanoseconds expected_time(std::uint64_t mesh_bytes, const PreprocessOptions& options);
/// As well of points scattered on a mesh file of so many bytes.
std::chrono::nanoseconds expected_scatter_time(std::uint64_t mesh_bytes, const MeshScatter& wanted);
/// As well of remesh(), for a mesh of so many vertices.
std::chrono::nanoseconds expected_remesh_time(std::uint64_t points);
/// As well of make_surface_file(), for the largest mesh that it takes.
std::chrono::nanoseconds expected_surface_time();

}  // namespace curvecast::server
