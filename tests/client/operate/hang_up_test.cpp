// SIGHUP where there are no files to read anew: what it means depends on whether there is a terminal.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

class HangUpTest : public CliTest {};

TEST_F(HangUpTest, IsNothingToAServerWithoutATerminal) {
  // As under systemd, whose `reload` sends it.
  Process server({"--", CURVECAST_COMMAND, "serve", "--listen", "127.0.0.1:0", "--http", "none"}, "/usr/bin/setsid");
  const std::string address = server.rest_of_line("listening on ");
  for (int i = 0; i < 3; ++i) {
    server.signal(SIGHUP);
    EXPECT_EQ(run({"sessions", "--server", address}).status, 0);
  }
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(HangUpTest, EndsAServerWhoseTerminalCloses) {
  int terminal = -1;
  const pid_t pid = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  if (pid < 0) GTEST_SKIP() << "there are no terminals here";
  if (pid == 0) {
    std::signal(SIGHUP, SIG_DFL);  // whatever these tests run under
    ::execl(CURVECAST_COMMAND, CURVECAST_COMMAND, "serve", "--listen", "127.0.0.1:0", "--http", "none", nullptr);
    _exit(127);
  }
  std::string written;
  std::array<char, 4096> bytes = {};
  while (written.find("listening on ") == std::string::npos) {
    const ssize_t count = ::read(terminal, bytes.data(), bytes.size());
    ASSERT_GT(count, 0) << written;  // it has ended
    written.append(bytes.data(), static_cast<std::size_t>(count));
  }
  ::close(terminal);
  int status = 0;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);
  EXPECT_TRUE(WIFSIGNALED(status)) << status;
  EXPECT_EQ(WTERMSIG(status), SIGHUP);
}

}  // namespace
}  // namespace curvecast::cli
