#include "core/mesh_io/mtl_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace curvecast {
namespace {

using ::testing::ElementsAre;

TEST(MtlReader, TakesColoursAndTextures) {
  const std::string text =
      "# a library\nKd 0 0 0\nnewmtl red paint \r\n  Kd 1 0 0.5\r\nd 0.5\nmap_Kd -s 1 1 1 -o 0.5 -mm 0 1 -clamp on my wood.png\n"
      "newmtl grey\nKd 0.2\nTr 0.25\nnewmtl odd\nKd spectral a.rfl\nmap_Kd -bm 2\nnewmtl";
  const std::vector<MtlMaterial> materials = read_mtl(text);
  ASSERT_EQ(materials.size(), 4u);
  EXPECT_EQ(materials[0].name, "red paint");
  EXPECT_EQ(materials[0].colour, (Rgba8{255, 0, 128, 128}));
  EXPECT_EQ(materials[0].texture, "my wood.png");
  EXPECT_EQ(materials[0].line, 6u);
  EXPECT_EQ(materials[1].colour, (Rgba8{51, 51, 51, 191}));
  EXPECT_EQ(materials[2].colour, Rgba8{});
  EXPECT_EQ(materials[2].texture, "");
  EXPECT_EQ(materials[3].name, "");
}

TEST(MtlReader, TellsTheNamesOfLibrariesApart) {
  EXPECT_THAT(library_names(" a.mtl  b.MTL\r"), ElementsAre("a.mtl", "b.MTL"));
  EXPECT_THAT(library_names(" my nice file.mtl other"), ElementsAre("my nice file.mtl", "other"));
  EXPECT_THAT(library_names("materials"), ElementsAre("materials"));
  EXPECT_THAT(library_names("  "), ElementsAre());
}

}  // namespace
}  // namespace curvecast
