#include "tests/core/mesh_io/gltf_writer.h"
#include "tests/support/hostile_files.h"

namespace curvecast::testing {
namespace {

/// Names that, taken as they are, would lead out of the mesh's folder, or to no file.
std::vector<std::string> unsafe_names() {
  return {"../../etc/passwd",
          "/etc/passwd",
          "a/../../../etc/passwd",
          "..\\..\\windows\\win.ini",
          "C:\\windows\\win.ini",
          "c:win.ini",
          "\\\\host\\share\\a.png",
          "https://example.org/a.png",
          "file:///etc/passwd",
          "%2e%2e/%2e%2e/etc/passwd",
          "..%2f..%2fetc%2fpasswd",
          "%2fetc%2fpasswd",
          "a%00b.png",
          "..",
          "/",
          ".",
          "~/../.ssh/id_rsa",
          "a.png\x7f",
          "\xff\xfe.png",
          std::string(5'000, '/') + "a",
          std::string(70'000, 'n')};
}

std::string printed(const std::string& name) {
  std::string out = name.substr(0, 40);
  for (char& c : out) c = c < ' ' || c == '\x7f' ? '?' : c;
  return out;
}

}  // namespace

std::vector<HostileFile> hostile_reference_files() {
  std::vector<HostileFile> files;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
  const auto add = [&](const std::string& what, const HostileFile& file) {
    files.push_back(file);
    files.back().what = what;
  };
  std::vector<std::string> names = unsafe_names();
  names.emplace_back("a\0b.png", 7);
  for (const std::string& name : names) {
    add("OBJ with the library " + printed(name), {.name = "a.obj",
                                                  .bytes = "mtllib " + name + "\n" + triangle,
                                                  .usable = true,
                                                  .words = {"line 1: the material library", "is not there"}});
    add("MTL with the texture " + printed(name), {.name = "a.obj",
                                                  .bytes = "mtllib a.mtl\n" + triangle,
                                                  .companions = {{"a.mtl", "newmtl m\nmap_Kd " + name + "\n"}},
                                                  .usable = true,
                                                  .words = {"line 2 of a.mtl: the texture"}});
    add("PLY with the texture " + printed(name),
        {.name = "a.ply",
         .bytes =
             "ply\nformat ascii 1.0\ncomment TextureFile " + name +
             "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
             "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n",
         .usable = true,
         .words = {"line 3: the texture"}});
    if (name.find_first_of("\x7f\xff") != std::string::npos) continue;  // no JSON
    add("glTF with the buffer " + printed(name),
        {.name = "a.gltf", .bytes = gltf_tetrahedron().text(name), .words = {"buffer 0 is in the file"}});
    GltfWriter writer = gltf_tetrahedron();
    writer.json["meshes"][0]["primitives"][0]["material"] = 0;
    writer.json["images"] = {{{"uri", name}}};
    writer.json["textures"] = {{{"source", 0}}};
    writer.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    add("glTF with the picture " + printed(name),
        {.name = "a.glb", .bytes = writer.glb(), .usable = true, .words = {"material 0: the texture"}});
  }
  return files;
}

}  // namespace curvecast::testing
