// Makes the checksums of damaged files right again, so that what comes after them is tried too.
#pragma once

#include <string>

namespace curvecast::fuzzing {

/// Of a file as core/storage/section_file.h describes it: its size and checksums become those that its bytes, its table and its
/// number of blocks call for. Leaves alone what is too short or contradicts itself.
void mend_section_file(std::string& file);

/// Of a file of server/session/mesh_folder.h: its checksum becomes what its texts and sizes call for. Returns the id of the mesh
/// that is in it then, or of no mesh.
std::string mend_mesh_file(std::string& file);

}  // namespace curvecast::fuzzing
