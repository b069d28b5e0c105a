#include "core/mesh_io/reading/companion_name.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace curvecast {
namespace {

TEST(CompanionName, KeepsWhatIsBesideTheMesh) {
  for (const char* name : {"a.mtl", "textures/wood 1.png", "tex/..hidden.png", "\xC3\xA4.png", "a...b"}) {
    EXPECT_EQ(safe_companion_name(name), name) << name;
  }
}

TEST(CompanionName, NormalisesOrKeepsTheLastComponent) {
  const std::pair<const char*, const char*> cases[] = {{"./a.png", "a.png"},
                                                       {"tex\\wood.png", "tex/wood.png"},
                                                       {"tex//a.png", "tex/a.png"},
                                                       {"/etc/passwd", "passwd"},
                                                       {"\\\\host\\share\\a.png", "a.png"},
                                                       {"C:\\Users\\me\\a.png", "a.png"},
                                                       {"c:a.png", "a.png"},
                                                       {"../a.png", "a.png"},
                                                       {"tex/../../a.png", "a.png"},
                                                       {"https://example.org/x/a.png", "a.png"},
                                                       {"file:///etc/shadow", "shadow"},
                                                       {"a.png:stream", "stream"}};
  for (const auto& [name, safe] : cases) EXPECT_EQ(safe_companion_name(name), safe) << name;
}

TEST(CompanionName, DropsWhatCannotBeMadeSafe) {
  for (const std::string name :
       {"", ".", "..", "/", "a/..", ":", "a\nb.png", "a\tb", "\x7f", "\xff.png", "\xC0\xAF", "\xED\xA0\x80"}) {
    EXPECT_EQ(safe_companion_name(name), std::nullopt) << name;
  }
  EXPECT_EQ(safe_companion_name(std::string("a\0b", 3)), std::nullopt);
  EXPECT_EQ(safe_companion_name(std::string(300, 'a')), std::nullopt);
  EXPECT_EQ(safe_companion_name(std::string(5'000'000, '/')), std::nullopt);
}

TEST(CompanionName, IsRelativeToTheCompanionThatNamesIt) {
  EXPECT_EQ(safe_companion_name("a.png", "b.mtl"), "a.png");
  EXPECT_EQ(safe_companion_name("a.png", "lib/b.mtl"), "lib/a.png");
  EXPECT_EQ(safe_companion_name("../../a.png", "lib/b.mtl"), "lib/a.png");
  EXPECT_EQ(safe_companion_name("..", "lib/b.mtl"), std::nullopt);
}

TEST(CompanionName, NeverLeavesTheFolderWhateverIsWritten) {
  std::mt19937 random(3);
  const std::string letters = "ab./\\: ~%\n";
  for (int round = 0; round < 50'000; ++round) {
    std::string name;
    for (std::uint32_t length = random() % 12; length > 0; --length) name += letters[random() % letters.size()];
    const auto safe = safe_companion_name(name);
    if (!safe) continue;
    EXPECT_FALSE(safe->empty());
    EXPECT_EQ(safe->find_first_of("\\:\n"), std::string::npos) << name;
    const std::string framed = "/" + *safe + "/";
    for (const char* bad : {"//", "/./", "/../"}) EXPECT_EQ(framed.find(bad), std::string::npos) << name << " -> " << *safe;
    EXPECT_EQ(safe_companion_name(*safe), safe);
  }
}

TEST(DisplayName, IsPlainText) {
  EXPECT_EQ(display_name("quality"), "quality");
  EXPECT_EQ(display_name("a\xff"), "a\\xff");
  for (const std::string& name : {std::string(1'000, 'x'), std::string(127, 'x') + "\xC3\xA4\xC3\xA4", std::string("\x01\x02")}) {
    EXPECT_TRUE(is_plain_text(display_name(name)));
    EXPECT_LE(display_name(name).size(), 600u);
  }
}

TEST(CompanionName, ControlCharactersAreNoPlainText) {
  for (const char* text : {"a\nb", "a\x7f", "a\xC2\x80",
                           "\xC2\x9B"
                           "31m",
                           "\xC2\x9F"})
    EXPECT_FALSE(is_plain_text(text));
  for (const char* text : {"a b", "\xC2\xA0", "\xC3\x80", "\xC3\xA4"}) EXPECT_TRUE(is_plain_text(text));
}

}  // namespace
}  // namespace curvecast
