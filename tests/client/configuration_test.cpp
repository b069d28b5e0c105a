#include "client/cli/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace curvecast::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A command with an option of each kind.
struct Example {
  Example() {
    app.add_option("--name", name)->capture_default_str();
    app.add_option("--max-size", size)->transform(CLI::AsSizeValue(false))->capture_default_str();
    app.add_option("--ratio", ratio)->check(CLI::Range(0.0, 1.0))->capture_default_str();
    app.add_option("--file", files)->allow_extra_args(false);
    app.add_flag("--loud", loud);
    app.add_option("--secret", secret)->configurable(false);
  }

  absl::Status run(const std::vector<std::string>& arguments, const std::string& file = "") {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 wants them backwards
    const auto configured = configure(app, file);
    if (configured.ok()) {
      for (const Setting& setting : *configured) settings[setting.name] = setting;
    }
    return configured.status();
  }

  CLI::App app;
  std::string name = "nobody", secret;
  std::uint64_t size = 10;
  double ratio = 0.5;
  std::vector<std::string> files;
  bool loud = false;
  std::map<std::string, Setting> settings;
};

class Configuration : public ::testing::Test {
 protected:
  void TearDown() override {
    for (const std::string& variable : variables_) ::unsetenv(variable.c_str());
  }
  void set(const std::string& variable, const std::string& value) {
    ::setenv(variable.c_str(), value.c_str(), 1);
    variables_.push_back(variable);
  }
  std::string write(const std::string& text) {
    std::ofstream(path_) << text;
    return path_;
  }
  void expect_refused(const std::string& text, const std::string& message) {
    Example example;
    const absl::Status status = example.run({}, write(text));
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(status.message(), HasSubstr(path_));
    EXPECT_THAT(status.message(), HasSubstr(message));
  }

  testing::TemporaryFolder folder_;
  std::string path_ = folder_ / "settings.toml";
  std::vector<std::string> variables_;
};

TEST_F(Configuration, VariablesAreNamedAfterOptions) { EXPECT_EQ(environment_name("max-size"), "CURVECAST_MAX_SIZE"); }

TEST_F(Configuration, WithoutAnyEverythingIsAsItWas) {
  Example example;
  ASSERT_TRUE(example.run({}).ok());
  EXPECT_EQ(example.name, "nobody");
  EXPECT_EQ(example.settings["name"].value, "nobody");
  EXPECT_EQ(example.settings["name"].source, "default");
  EXPECT_EQ(example.settings["loud"].value, "false");
  EXPECT_FALSE(example.settings.contains("secret"));
  EXPECT_FALSE(example.settings.contains("help"));
}

TEST_F(Configuration, FlagsBeatTheEnvironmentAndThatTheFile) {
  const std::string file =
      write("# a comment\nname = \"file\"\nmax-size = \"2KB\"\nratio = 0.25\nloud = true\nfile = [\"a\", \"b c\"]\n");
  set("CURVECAST_MAX_SIZE", "3KB");
  set("CURVECAST_NAME", "environment");
  set("CURVECAST_RATIO", "");  // as if it were not set
  Example example;
  const absl::Status status = example.run({"--name", "flag"}, file);
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(example.name, "flag");
  EXPECT_EQ(example.size, 3072u);
  EXPECT_EQ(example.ratio, 0.25);
  EXPECT_TRUE(example.loud);
  EXPECT_THAT(example.files, ElementsAre("a", "b c"));
  EXPECT_EQ(example.settings["name"].source, "flag");
  EXPECT_EQ(example.settings["max-size"].source, "CURVECAST_MAX_SIZE");
  EXPECT_EQ(example.settings["max-size"].value, "3072");
  EXPECT_EQ(example.settings["ratio"].source, file);
  EXPECT_EQ(example.settings["loud"].value, "true");
}

TEST_F(Configuration, TheEnvironmentSpeaksForAllKinds) {
  set("CURVECAST_FILE", "https://a.example:8080; b c;");
  set("CURVECAST_LOUD", "true");
  set("CURVECAST_SECRET", "x");  // cannot be configured
  Example example;
  ASSERT_TRUE(example.run({}).ok());
  EXPECT_THAT(example.files, ElementsAre("https://a.example:8080", "b c"));
  EXPECT_EQ(example.settings["file"].value, "https://a.example:8080;b c");
  EXPECT_TRUE(example.loud);
  EXPECT_EQ(example.secret, "");
  set("CURVECAST_LOUD", "false");
  Example quiet;
  ASSERT_TRUE(quiet.run({}).ok());
  EXPECT_FALSE(quiet.loud);
}

TEST_F(Configuration, ErrorsSayWhatIsWrongWhere) {
  expect_refused("nam = 1\nname = \"x\"\nvolume = 2\n", "there is no setting named nam, volume; there are: file, loud, max-size");
  expect_refused("secret = 1\n", "secret");
  expect_refused("[table]\nname = 1\n", "[table]");
  expect_refused("a.name = 1\n", "a");
  expect_refused("name = \"a\"\nratio = 0.1\nname = \"b\"\n", "name is there twice");
  expect_refused("name = [\"a\", \"b\"]\n", "name: takes one value, not 2");
  expect_refused("ratio = 7\n", "ratio");
  expect_refused("max-size = \"many\"\n", "max-size");
  expect_refused("loud = \"perhaps\"\n", "loud");
  expect_refused("nonsense\n", "nonsense");
  expect_refused("name = \"a # b\"\n", "name: quotes are not closed");
  set("CURVECAST_RATIO", "much");
  Example example;
  const absl::Status status = example.run({});
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("CURVECAST_RATIO: "));
  EXPECT_EQ(Example().run({}, "/nonexistent.toml").code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(Example().run({}, "/nonexistent.toml").message(), HasSubstr("/nonexistent.toml"));
}

TEST_F(Configuration, WhatIsPrintedIsReadAgain) {
  Example written;
  ASSERT_TRUE(written.run({"--name", "a name", "--max-size", "5KB", "--file", "x y", "--file", "z", "--loud"}).ok());
  const std::string file = write(to_configuration(written.app));
  Example read;
  const absl::Status status = read.run({}, file);
  ASSERT_TRUE(status.ok()) << status << to_configuration(written.app);
  EXPECT_EQ(read.name, "a name");
  EXPECT_EQ(read.size, 5120u);
  EXPECT_EQ(read.ratio, 0.5);
  EXPECT_THAT(read.files, ElementsAre("x y", "z"));
  EXPECT_TRUE(read.loud);
  EXPECT_EQ(to_configuration(read.app), to_configuration(written.app));
}

TEST_F(Configuration, WhatWasNotSetStaysSo) {
  Example written;
  ASSERT_TRUE(written.run({}).ok());
  Example read;
  const absl::Status status = read.run({}, write(to_configuration(written.app)));
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_TRUE(read.files.empty());
  EXPECT_EQ(read.settings["file"].source, "default");
}

}  // namespace
}  // namespace curvecast::cli
