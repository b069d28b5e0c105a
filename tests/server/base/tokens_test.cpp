#include "server/base/tokens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// printf %s secret | sha256sum; printf %s other | sha256sum
constexpr char kSecret[] = "2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b";
constexpr char kOther[] = "d9298a10d1b0735837dc4bd85dac641b0f3cef27a47e5d53a54f2f3f5b2fcffa";

Tokens::Clock::time_point at(std::int64_t seconds) { return Tokens::Clock::time_point(std::chrono::seconds(seconds)); }

std::string name_of(const absl::StatusOr<Tokens::Holder>& holder) { return holder.ok() ? holder->name : ""; }

TEST(Tokens, NameTheirHolders) {
  const auto tokens =
      Tokens::parse(std::string("# who may call\n\nanna ") + kSecret + "\r\n  bert\t" + kOther + " 1000\n", "tokens");
  ASSERT_TRUE(tokens.ok()) << tokens.status();
  EXPECT_EQ((*tokens)->size(), 2u);
  EXPECT_EQ(name_of((*tokens)->authenticate("Bearer secret")), "anna");
  EXPECT_EQ(name_of((*tokens)->authenticate("bearer  secret ")), "anna");
  EXPECT_EQ(name_of((*tokens)->authenticate("Bearer other", at(999))), "bert");
  const absl::Status expired = (*tokens)->authenticate("Bearer other", at(1000)).status();
  EXPECT_TRUE(absl::IsUnauthenticated(expired));
  EXPECT_THAT(expired.message(), HasSubstr("expired"));
  for (const std::string header : {"", "Bearer", "Bearer ", "Bearer Secret", "Basic secret", "secret"}) {
    EXPECT_TRUE(absl::IsUnauthenticated((*tokens)->authenticate(header).status())) << header;
  }
}

TEST(Tokens, KnowWhoHasLostHis) {
  const auto before = Tokens::parse(std::string("anna ") + kSecret + "\nbert " + kOther + " 1000\n", "tokens");
  ASSERT_TRUE(before.ok()) << before.status();
  const auto anna = (*before)->authenticate("Bearer secret"), bert = (*before)->authenticate("Bearer other", at(999));
  ASSERT_TRUE(anna.ok() && bert.ok());
  EXPECT_TRUE((*before)->check(*anna).ok());
  EXPECT_TRUE((*before)->check(*bert, at(999)).ok());
  EXPECT_TRUE(absl::IsUnauthenticated((*before)->check(*bert, at(1000))));
  for (const std::string& after : {std::string("bert ") + kOther, std::string("carl ") + kSecret}) {
    const auto tokens = Tokens::parse(after, "tokens");
    ASSERT_TRUE(tokens.ok()) << tokens.status();
    EXPECT_TRUE(absl::IsUnauthenticated((*tokens)->check(*anna))) << after;
  }
}

TEST(Tokens, RefuseAFileThatMakesNoSense) {
  const auto message_of = [](const std::string& text) {
    const absl::Status status = Tokens::parse(text, "tokens").status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    return std::string(status.message());
  };
  EXPECT_THAT(message_of(std::string("a ") + kSecret + "\nb"), HasSubstr("line 2"));
  EXPECT_THAT(message_of("a secret"), Not(HasSubstr("secret"))) << "what may be a token is not repeated";
  EXPECT_THAT(message_of(std::string("a ") + kSecret + " soon"), HasSubstr("time"));
  EXPECT_THAT(message_of(std::string("a ") + kSecret + "\nb " + kSecret), HasSubstr("already"));
  EXPECT_THAT(message_of("# nobody\n"), HasSubstr("no tokens"));
}

TEST(Tokens, AreReadFromAFile) {
  const testing::TemporaryFolder folder;
  testing::write_file(folder / "tokens", std::string("anna ") + kSecret);
  EXPECT_TRUE(Tokens::read(folder / "tokens").ok());
  EXPECT_TRUE(absl::IsNotFound(Tokens::read(folder / "none").status()));
  EXPECT_FALSE(Tokens::read(folder.path()).ok());
}

}  // namespace
}  // namespace curvecast::server
