// What a crash leaves to those who look for its cause.
#include <csignal>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;

class CrashTest : public CliTest {
 protected:
  Process server_{{"serve", "--listen", "127.0.0.1:0", "--http", "none"}};

  Finished end_by(int signal) {
    server_.rest_of_line("listening on ");
    server_.signal(signal);
    return server_.finish();
  }
};

TEST_F(CrashTest, SaysWhichSignalItWasAndWhere) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitisers have reports of their own";
#endif
  const Finished crashed = end_by(SIGSEGV);
  EXPECT_EQ(crashed.status, 128 + SIGSEGV);
  EXPECT_THAT(crashed.err, HasSubstr("crashed, SIGSEGV"));
  EXPECT_THAT(crashed.err, HasSubstr("curvecast(+0x"));  // main() waits, at least
}

TEST_F(CrashTest, ToBeEndedIsNone) {
  const Finished ended = end_by(SIGTERM);
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err.find("crashed"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace curvecast::cli
