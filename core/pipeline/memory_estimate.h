// How much memory the stages from a file to a curve take, told before they take it. Upper bounds, measured on made and scanned
// meshes: see tests/core/pipeline/memory_estimate_test.cpp.
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <string>

#include "core/base/execution_context.h"
#include "core/base/memory_claim.h"
#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

struct PreprocessOptions;

/// Returns the bytes that a soup takes.
double soup_bytes(const PolygonSoup& soup);

/// Each sets what the computation takes for what comes next; errors as of MemoryClaim::set(), which name the file and say what
/// would fit.
absl::Status claim_reading(const MeshFile& file, MemoryClaim& claim);
/// To repair and inspect what has been read.
absl::Status claim_repair(const MeshFile& file, const PolygonSoup& soup, MemoryClaim& claim);
/// To repair, cut, parameterise and lay the curve that the options ask for.
absl::Status claim_preprocessing(const MeshFile& file, const PolygonSoup& soup, const PreprocessOptions& options,
                                 const ExecutionContext& context, MemoryClaim& claim);
/// To lay that curve, on whichever mesh: what can be told before anything has been read.
absl::Status claim_curve(const std::string& name, const PreprocessOptions& options, const ExecutionContext& context,
                         MemoryClaim& claim);
/// For a curve of so many vertices: those beyond what claim_preprocessing() has foreseen.
absl::Status claim_more_leaves(std::uint64_t leaves, const PreprocessOptions& options, MemoryClaim& claim);

}  // namespace curvecast
