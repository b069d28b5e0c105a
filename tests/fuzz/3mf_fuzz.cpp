// ZIP archives as they are; anything else becomes the model of one, so that what is tried is not lost to sums of bytes.
#include <string>
#include <string_view>

#include "tests/core/mesh_io/three_mf_writer.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/fuzz_mesh.h"

void curvecast::fuzzing::take_input(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  if (input.starts_with("PK")) return fuzz_mesh(MeshFormat::kThreeMf, "a.3mf", data, size);
  const std::string file = three_mf_file(std::string(input), {}, true);
  fuzz_mesh(MeshFormat::kThreeMf, "a.3mf", reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
}
