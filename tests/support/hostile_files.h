// Files that are broken, or made to hurt: the one home of them. For each format in a source of its own; always the same bytes.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace curvecast::testing {

struct HostileFile {
  std::string what;   // unique among all
  std::string name;   // of the mesh file, as the user knows it
  std::string bytes;  // whole
  std::map<std::string, std::string, std::less<>> companions = {};
  bool usable = false;                         // read and repaired all the same; else refused by one of the two
  std::size_t memory = std::size_t{16} << 20;  // bytes that reading it may take besides twice its own, at once
  std::vector<std::string> words;  // all in the message, which begins with the name; of usable files all in one of the warnings
};

std::vector<HostileFile> hostile_files();

std::vector<HostileFile> hostile_ply_files();
std::vector<HostileFile> hostile_obj_files();        // and material libraries
std::vector<HostileFile> hostile_off_stl_files();    // and files of no format
std::vector<HostileFile> hostile_gltf_files();       // and GLB
std::vector<HostileFile> hostile_packed_files();     // glTF with Draco and meshopt
std::vector<HostileFile> hostile_three_mf_files();   // and ZIP archives, and XML
std::vector<HostileFile> hostile_texture_files();    // pictures, by way of meshes that wear them
std::vector<HostileFile> hostile_reference_files();  // names that lead out of the mesh's folder

}  // namespace curvecast::testing
