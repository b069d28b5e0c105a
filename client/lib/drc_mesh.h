// SPDX-License-Identifier: Apache-2.0
// Draco mesh files (.drc), as Draco's own draco_decoder and three.js open them.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "drc_file.h"
#include "mesh.h"

namespace curvecast::client {

/// The bytes of a file with one mesh in absolute coordinates: POSITION, NORMAL, COLOR of three bytes; all but the first where the
/// vertices have them. Draco puts vertices and triangles into an order of its own. InvalidArgument for no triangles or options
/// out of range; Internal with Draco's message.
absl::StatusOr<std::string> make_drc_mesh(const Mesh& mesh, const DrcOptions& options = {});

}  // namespace curvecast::client
