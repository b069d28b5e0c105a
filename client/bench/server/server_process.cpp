#include "client/bench/server/server_process.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include "client/cli/sibling_program.h"

namespace curvecast::cli::bench {
namespace {

constexpr std::string_view kReady = "listening on ";

/// The first line that begins with kReady; empty at the end of what is written.
std::string read_address(int pipe) {
  std::string text;
  std::array<char, 256> buffer;
  for (ssize_t count; (count = ::read(pipe, buffer.data(), buffer.size())) > 0;) {
    text.append(buffer.data(), static_cast<std::size_t>(count));
    const std::size_t begin = text.find(kReady), end = text.find('\n', begin);
    if (end != std::string::npos) return text.substr(begin + kReady.size(), end - begin - kReady.size());
  }
  return {};
}

std::string content_of(const std::string& path) {
  std::ostringstream content;
  content << std::ifstream(path).rdbuf();
  return content.str();
}

}  // namespace

absl::StatusOr<std::unique_ptr<ServerProcess>> ServerProcess::start(const std::string& command, int threads) {
  const absl::StatusOr<std::string> program = command.empty() ? sibling_program("curvecast") : command;
  if (!program.ok()) return program.status();
  std::vector<std::string> words = {*program,
                                    "serve",
                                    "--listen",
                                    "127.0.0.1:0",
                                    "--quiet",
                                    "--threads",
                                    absl::StrCat(threads),
                                    "--max-streams",
                                    "20000",
                                    "--max-streams-of-client",
                                    "20000"};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::array<int, 2> pipe;
  if (::pipe(pipe.data()) != 0) return absl::UnavailableError(absl::StrCat("no pipe: ", std::strerror(errno)));
  const pid_t parent = ::getpid(), pid = ::fork();
  if (pid == 0) {
    // Only calls that are safe between fork and exec. However this process ends, the server does not stay behind.
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(127);
    ::dup2(pipe[1], STDOUT_FILENO);
    ::close(pipe[0]);
    ::close(pipe[1]);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  const int error = errno;
  ::close(pipe[1]);
  std::string address = pid > 0 ? read_address(pipe[0]) : "";
  ::close(pipe[0]);
  if (pid < 0) return absl::UnavailableError(absl::StrCat("the server cannot be run: ", std::strerror(error)));
  std::unique_ptr<ServerProcess> server(new ServerProcess(pid, std::move(address)));
  if (server->address_.empty()) return absl::UnavailableError("the server ended before it was ready");
  return server;
}

ServerProcess::~ServerProcess() {
  ::kill(pid_, SIGTERM);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

double ServerProcess::cpu_milliseconds() const {
  const std::string stat = content_of(absl::StrCat("/proc/", pid_, "/stat"));
  // The second field, in brackets, may hold blanks. User and system time are the 14th and 15th.
  const std::vector<std::string> fields = absl::StrSplit(stat.substr(std::min(stat.rfind(')'), stat.size())), ' ');
  double ticks = 0;
  for (std::size_t i = 12; i < 14 && i < fields.size(); ++i) {
    double more = 0;
    if (absl::SimpleAtod(fields[i], &more)) ticks += more;
  }
  return 1e3 * ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

std::uint64_t ServerProcess::resident_bytes() const {
  std::istringstream statm(content_of(absl::StrCat("/proc/", pid_, "/statm")));
  std::uint64_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t ServerProcess::peak_bytes() const {
  std::istringstream status(content_of(absl::StrCat("/proc/", pid_, "/status")));
  for (std::string word; status >> word;) {
    std::uint64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return 1024 * kibibytes;
  }
  return 0;
}

}  // namespace curvecast::cli::bench
