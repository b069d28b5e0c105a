// Bad input never hurts: every hostile file is refused with words that say where, or used as far as it is good.
#include "tests/support/hostile_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "core/mesh/repair.h"
#include "core/mesh_io/mesh_companions.h"
#include "core/mesh_io/mesh_io.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/counted_memory.h"
#include "tests/support/mesh_promises.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;
using testing::HostileFile;
using testing::is_safe_name;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// The file with its companions; each name that is asked for must be safe. Both arguments outlive the result.
MeshFile opened(const HostileFile& hostile, const std::vector<char>& bytes) {
  return {.name = hostile.name, .bytes = bytes, .companion = [&hostile](std::string_view name) {
            EXPECT_TRUE(is_safe_name(name)) << name;
            const auto found = hostile.companions.find(name);
            return found == hostile.companions.end() ? std::nullopt : std::optional<std::span<const char>>(found->second);
          }};
}

/// Nothing behind the bytes may be read.
std::vector<char> exact(const HostileFile& hostile) { return {hostile.bytes.begin(), hostile.bytes.end()}; }

void expect_words(const std::string& text, const HostileFile& hostile) {
  for (const std::string& words : hostile.words) EXPECT_THAT(text, HasSubstr(words));
}

void expect_refused(const absl::Status& status, const HostileFile& hostile) {
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  expect_words(std::string(status.message()), hostile);
}

/// The first warning that has the first of the words has all of them.
void expect_warning(const std::vector<std::string>& warnings, const HostileFile& hostile) {
  if (hostile.words.empty()) return;
  for (const std::string& warning : warnings) {
    if (warning.find(hostile.words.front()) != std::string::npos) return expect_words(warning, hostile);
  }
  ADD_FAILURE() << "no warning with '" << hostile.words.front() << "' among: " << ::testing::PrintToString(warnings);
}

TEST(HostileFiles, AreManyAndDiffer) {
  std::set<std::string> seen;
  for (const HostileFile& hostile : testing::hostile_files()) {
    EXPECT_TRUE(seen.insert(hostile.what).second) << hostile.what;
    EXPECT_TRUE(hostile.usable || !hostile.words.empty()) << hostile.what;
  }
  EXPECT_GE(seen.size(), 400u);
}

TEST(HostileFiles, AreRefusedOrRepaired) {
  for (const HostileFile& hostile : testing::hostile_files()) {
    SCOPED_TRACE(hostile.what);
    const std::vector<char> bytes = exact(hostile);
    const absl::StatusOr<PolygonSoup> soup = read_mesh(opened(hostile, bytes));
    if (!soup.ok()) {
      EXPECT_FALSE(hostile.usable) << soup.status();
      EXPECT_THAT(std::string(soup.status().message()), StartsWith(hostile.name + ": "));
      expect_refused(soup.status(), hostile);
      continue;
    }
    EXPECT_EQ(testing::broken_promise(*soup), "");
    const absl::StatusOr<RepairedMesh> repaired = repair(*soup);
    EXPECT_EQ(repaired.ok(), hostile.usable) << repaired.status();
    if (!repaired.ok()) {
      expect_refused(repaired.status(), hostile);
      continue;
    }
    EXPECT_EQ(testing::broken_promise(*repaired), "");
    expect_warning(soup->warnings, hostile);
  }
}

TEST(HostileFiles, GoTheWholeWayOrEndWithAMessage) {
  for (const HostileFile& hostile : testing::hostile_files()) {
    SCOPED_TRACE(hostile.what);
    const std::vector<char> bytes = exact(hostile);
    const absl::StatusOr<Preprocessed> result = preprocess(opened(hostile, bytes), {.points = 100});
    EXPECT_EQ(result.ok(), hostile.usable) << result.status();
    if (result.ok()) {
      EXPECT_GE(result->curve->size(), 1000u);
      expect_warning(result->report.mesh.warnings, hostile);
    } else {
      EXPECT_THAT(std::string(result.status().message()), StartsWith(hostile.name + ": "));
      expect_refused(result.status(), hostile);
    }
  }
}

TEST(HostileFiles, AskForSafeNamesOnly) {
  for (const HostileFile& hostile : testing::hostile_files()) {
    SCOPED_TRACE(hostile.what);
    const std::vector<char> bytes = exact(hostile);
    const absl::StatusOr<std::vector<std::string>> missing = mesh_companions(opened(hostile, bytes));
    if (!missing.ok()) continue;
    EXPECT_LE(missing->size(), kMaxCompanions);
    for (const std::string& name : *missing) EXPECT_TRUE(is_safe_name(name)) << name;
  }
}

TEST(HostileFiles, TakeMemoryInProportion) {
  for (const HostileFile& hostile : testing::hostile_files()) {
    SCOPED_TRACE(hostile.what);
    const std::vector<char> bytes = exact(hostile);
    const MeshFile file = opened(hostile, bytes);
    std::size_t given = bytes.size();
    for (const auto& [name, companion] : hostile.companions) given += companion.size();
    const testing::CountedMemory memory;
    static_cast<void>(read_mesh(file));
    EXPECT_LE(memory.peak(), 2 * given + hostile.memory) << given << " bytes";
  }
}

}  // namespace
}  // namespace curvecast
