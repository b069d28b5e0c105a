#include "tests/support/hostile_files.h"

#include <iterator>
#include <utility>

namespace curvecast::testing {

std::vector<HostileFile> hostile_files() {
  std::vector<HostileFile> all;
  for (std::vector<HostileFile> some :
       {hostile_ply_files(), hostile_obj_files(), hostile_off_stl_files(), hostile_gltf_files(), hostile_packed_files(),
        hostile_three_mf_files(), hostile_texture_files(), hostile_reference_files()}) {
    all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  }
  return all;
}

}  // namespace curvecast::testing
