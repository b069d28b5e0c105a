// The meshes of figures that need none of the user's: a square and a sphere, as files.
#pragma once

#include <string>

namespace curvecast::cli::bench {

/// The unit square in the plane z = 0, two triangles, as OBJ.
std::string square_obj();

/// A sphere of radius 1 about the origin, 64 by 128 faces, as OFF.
std::string sphere_off();

}  // namespace curvecast::cli::bench
