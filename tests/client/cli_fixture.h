// The real command, and a sphere to run it on.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/cli/points_io.h"
#include "client/lib/file_bytes.h"
#include "tests/client/process.h"

namespace curvecast::cli {

using nlohmann::json;

/// A folder of this process: CTest runs each test as one of its own, many at once.
std::string folder();
std::string temporary(const std::string& name);

/// A sphere of `rings` x 2 `rings` quads with its poles, as an OFF file.
std::string write_sphere(const std::string& name, int rings);

class CliTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::filesystem::create_directories(folder());
    ASSERT_EQ(::setenv("XDG_CACHE_HOME", temporary("cache").c_str(), 1), 0);
    sphere_ = write_sphere("sphere.off", 12);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder()); }

  /// Runs to success and parses standard output.
  static json run_json(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return json::parse(finished.out, nullptr, false);
  }
  static void expect_failure(const std::vector<std::string>& arguments, int status, const std::string& message) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, status) << ::testing::PrintToString(arguments) << finished.err;
    EXPECT_THAT(finished.err, ::testing::HasSubstr("curvecast: "));
    EXPECT_THAT(finished.err, ::testing::HasSubstr(message));
    EXPECT_THAT(finished.out, ::testing::IsEmpty());
  }
  static std::string bytes_of(const std::string& path) {
    const auto bytes = client::read_bytes(path, 1 << 30);
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    return bytes.value_or("");
  }
  static void expect_keys(const json& object, const std::vector<std::string>& keys) {
    for (const std::string& key : keys) EXPECT_TRUE(object.contains(key)) << key << " is missing in " << object.dump();
  }

  static inline std::string sphere_;
};

}  // namespace curvecast::cli
