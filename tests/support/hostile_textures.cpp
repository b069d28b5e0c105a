#include <zlib.h>

#include <cstdint>

#include "tests/core/mesh_io/gltf_writer.h"
#include "tests/core/mesh_io/image_writers.h"
#include "tests/support/hostile_files.h"

namespace curvecast::testing {
namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";

std::string png() { return png_file(plain_image(4, 3, 10, 20, 30)); }
std::string jpeg() { return jpeg_file(plain_image(16, 8, 10, 20, 30)); }

/// A PNG whose header, its checksum right, claims another size.
std::string png_that_claims(std::uint32_t width, std::uint32_t height) {
  constexpr std::size_t kType = 12, kSize = 16, kChecksum = 29;
  const std::string whole = png();
  std::string file = whole.substr(0, kSize);
  append(file, width, true);
  append(file, height, true);
  file += whole.substr(kSize + 8, kChecksum - kSize - 8);
  append(file, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(file.data()) + kType, kChecksum - kType)),
         true);
  return file + whole.substr(kChecksum + 4);
}

std::string jpeg_that_claims(std::uint16_t width, std::uint16_t height) {
  std::string file = jpeg();
  const std::size_t frame = file.find("\xff\xc0");
  std::string size;
  append(size, height, true);
  append(size, width, true);
  return file.replace(frame + 5, 4, size);
}

/// Of the lossy kind, whose size stands behind the mark of its frame.
std::string webp_that_claims(std::uint16_t width, std::uint16_t height) {
  std::string file = webp_file(plain_image(16, 8, 10, 20, 30), false);
  const std::size_t mark = file.find("\x9d\x01\x2a");
  std::string size;
  append(size, width);
  append(size, height);
  return file.replace(mark + 3, 4, size);
}

struct Picture {
  const char* what;
  std::string name;
  std::string bytes;
  std::vector<std::string> words;  // of the warning; none: the picture is taken as far as it goes
};

std::vector<Picture> pictures() {
  const std::string beyond = "pixels, which is more than the 67108864 that are left for textures";
  const std::string whole_png = png(), whole_jpeg = jpeg(), whole_webp = webp_file(plain_image(16, 8, 10, 20, 30), false);
  return {{"an empty texture", "t.png", "", {"is neither PNG, JPEG nor WebP"}},
          {"a GIF", "t.gif", "GIF89a", {"the texture 't.gif' is neither PNG, JPEG nor WebP"}},
          {"a PNG's magic", "t.png", whole_png.substr(0, 8), {"is a broken PNG"}},
          {"a PNG's header", "t.png", whole_png.substr(0, 33), {"is a broken PNG"}},
          {"a PNG cut within its pixels", "t.png", whole_png.substr(0, whole_png.find("IDAT") + 8), {"is a broken PNG"}},
          {"a PNG of 0 x 0", "t.png", png_that_claims(0, 0), {"is a broken PNG"}},
          {"a PNG of 65535 x 65535", "t.png", png_that_claims(65'535, 65'535), {"has 65535 x 65535 " + beyond}},
          {"a PNG of 2^31 - 1 x 2^31 - 1", "t.png", png_that_claims(INT32_MAX, INT32_MAX), {"the texture 't.png'"}},
          {"a PNG of 2^32 - 1 x 2^32 - 1", "t.png", png_that_claims(UINT32_MAX, UINT32_MAX), {"is a broken PNG"}},
          {"a PNG of 8,000 x 8,000 in few bytes",
           "t.png",
           png_that_claims(8'000, 8'000),
           {"claims 8000 x 8000 pixels, more than its"}},
          {"a PNG of 60,000,000 x 1", "t.png", png_that_claims(60'000'000, 1), {"the texture 't.png'"}},
          {"a PNG with a wrong checksum", "t.png", std::string(whole_png).replace(29, 4, "\1\2\3\4"), {"is a broken PNG"}},
          {"a JPEG's magic", "t.jpg", "\xff\xd8\xff", {"has no pixels"}},
          {"a JPEG's header", "t.jpg", whole_jpeg.substr(0, 40), {"has no pixels"}},
          {"a JPEG cut within its pixels", "t.jpg", whole_jpeg.substr(0, whole_jpeg.size() - 20), {}},
          {"a JPEG of 0 x 0", "t.jpg", jpeg_that_claims(0, 0), {"the texture 't.jpg'"}},
          {"a JPEG of 65535 x 65535", "t.jpg", jpeg_that_claims(65'535, 65'535), {"the texture 't.jpg'"}},
          {"a JPEG of 65500 x 65500", "t.jpg", jpeg_that_claims(65'500, 65'500), {"has 65500 x 65500 " + beyond}},
          {"a JPEG that claims 65500 x 1000",
           "t.jpg",
           jpeg_that_claims(65'500, 1'000),
           {"claims 65500 x 1000 pixels, more than its"}},
          {"a WebP's magic", "t.webp", whole_webp.substr(0, 12), {"is a broken WebP"}},
          {"a WebP's header", "t.webp", whole_webp.substr(0, 30), {"is a broken WebP"}},
          {"a WebP cut within its pixels", "t.webp", whole_webp.substr(0, whole_webp.size() - 20), {"is a broken WebP"}},
          {"a WebP of 16383 x 16383", "t.webp", webp_that_claims(16'383, 16'383), {"has 16383 x 16383 " + beyond}},
          {"a WebP of 8000 x 8000 in few bytes",
           "t.webp",
           webp_that_claims(8'000, 8'000),
           {"claims 8000 x 8000 pixels, more than its"}},
          {"a JPEG of FFs", "t.jpg", std::string(100'000, '\xff'), {"is neither PNG, JPEG nor WebP"}}};
}

/// The triangle in a PLY, with what `texture_files` names as its textures.
std::string ply(const std::string& texture_files) {
  return "ply\nformat ascii 1.0\n" + texture_files +
         "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
         "element face 1\nproperty list uchar int vertex_indices\nproperty int texnumber\nend_header\n"
         "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2 ";
}

}  // namespace

std::vector<HostileFile> hostile_texture_files() {
  std::vector<HostileFile> files;
  for (const Picture& picture : pictures()) {
    std::vector<std::string> words = picture.words;
    if (!words.empty()) words.insert(words.begin(), "line 2 of a.mtl");
    files.push_back({.what = std::string("OBJ with ") + picture.what,
                     .name = "a.obj",
                     .bytes = "mtllib a.mtl\n" + kTriangle,
                     .companions = {{"a.mtl", "newmtl m\nmap_Kd " + picture.name + "\n"}, {picture.name, picture.bytes}},
                     .usable = true,
                     .words = words});
    GltfWriter writer = gltf_tetrahedron();
    writer.json["meshes"][0]["primitives"][0]["material"] = 0;
    writer.json["images"] = {{{"uri", picture.name}}};
    writer.json["textures"] = {{{"source", 0}}};
    writer.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    if (!words.empty()) words.front() = "material 0: ";
    files.push_back({.what = std::string("glTF with ") + picture.what,
                     .name = "a.glb",
                     .bytes = writer.glb(),
                     .companions = {{picture.name, picture.bytes}},
                     .usable = true,
                     .words = words});
  }
  std::string many, libraries;
  for (int i = 0; i < 5'000; ++i) many += "comment TextureFile t" + std::to_string(i) + ".png\n";
  const auto add = [&](const char* what, const std::string& bytes, const std::string& words) {
    files.push_back({.what = what,
                     .name = "a.ply",
                     .bytes = bytes,
                     .companions = {{"t.png", png()}},
                     .usable = true,
                     .words = words.empty() ? std::vector<std::string>() : std::vector{words}});
  };
  add("PLY of 5,000 textures that are not there", ply(many) + "4999\n", "line 3: the texture 't0.png' is not there");
  add("PLY of texture -1", ply("comment TextureFile t.png\n") + "-1\n", "");
  add("PLY of texture 2^63", ply("comment TextureFile t.png\n") + "9223372036854775808\n", "");
  add("PLY of texture NaN", ply("comment TextureFile t.png\n") + "nan\n", "");
  GltfWriter writer = gltf_tetrahedron();
  writer.json["meshes"][0]["primitives"][0]["material"] = 0;
  writer.json["images"] = {{{"bufferView", 99}, {"mimeType", "image/png"}}};
  writer.json["textures"] = {{{"source", 0}}};
  writer.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  files.push_back({.what = "glTF with a picture in a view that is not there",
                   .name = "a.glb",
                   .bytes = writer.glb(),
                   .usable = true,
                   .words = {"material 0: the texture 'image 0' cannot be read (there is no buffer view 99"}});
  const nlohmann::json transforms[] = {nlohmann::json::object(),
                                       7,
                                       {{"texCoord", 1e300}, {"rotation", 1e300}},
                                       {{"texCoord", "none"}, {"offset", {"a", "b"}}, {"scale", {1}}, {"rotation", {}}}};
  for (const nlohmann::json& transform : transforms) {
    GltfWriter moved = gltf_tetrahedron();
    nlohmann::json& primitive = moved.json["meshes"][0]["primitives"][0];
    primitive["material"] = 0;
    primitive["attributes"]["TEXCOORD_0"] = moved.floats({0, 0, 1, 0, 0, 1, 1, 1}, "VEC2");
    const nlohmann::json texture = {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}};
    moved.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}}};
    files.push_back({.what = "glTF with the texture transform " + transform.dump(),
                     .name = "a.glb",
                     .bytes = moved.glb(),
                     .usable = true,
                     .words = {"material 0: the texture 'image -1' cannot be read (is not in the file)"}});
  }
  return files;
}

}  // namespace curvecast::testing
