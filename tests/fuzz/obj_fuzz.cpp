#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/fuzz_mesh.h"

void curvecast::fuzzing::take_input(const std::uint8_t* data, std::size_t size) {
  fuzz_mesh(MeshFormat::kObj, "a.obj", data, size);
}
