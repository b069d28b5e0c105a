#include "tests/client/process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "tests/server/eventually.h"

namespace curvecast::cli {
namespace {

std::string content_of(const std::string& path) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

std::string new_path(const std::string& kind) {
  static std::atomic<int> counter = 0;
  return ::testing::TempDir() + "/curvecast_cli_" + std::to_string(getpid()) + "_" + std::to_string(counter++) + kind;
}

/// What follows `prefix` in a whole line of what was written.
std::optional<std::string> rest_of_line_in(const std::string& written, const std::string& prefix) {
  const std::size_t at = written.find(prefix);
  const std::size_t end = at == std::string::npos ? at : written.find('\n', at + prefix.size());
  if (end == std::string::npos) return std::nullopt;
  return written.substr(at + prefix.size(), end - at - prefix.size());
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments, const std::string& program)
    : out_path_(new_path(".out")), err_path_(new_path(".err")) {
  EXPECT_NE(std::getenv("XDG_CACHE_HOME"), nullptr) << "tests leave the user's own cache alone: set another one";
  std::vector<std::string> words = {program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ != 0) {
    // kill(-1) and waitpid(-1) mean every process: a child that never was must not be signalled or waited for.
    running_ = pid_ > 0;
    EXPECT_GT(pid_, 0) << "fork: " << std::strerror(errno);
    return;
  }
  // The child: only calls that are safe between fork and exec.
  const int out = ::open(out_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err = ::open(err_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  ::execv(argv[0], argv.data());
  _exit(127);
}

Process::~Process() {
  if (running_ && !reap(false)) {
    signal(SIGKILL);
    reap(true);
  }
  std::remove(out_path_.c_str());
  std::remove(err_path_.c_str());
}

bool Process::reap(bool block) {
  if (running_ && ::waitpid(pid_, &status_, block ? 0 : WNOHANG) == pid_) running_ = false;
  return !running_;
}

void Process::signal(int number) {
  sent_ = number;
  if (running_ && pid_ > 0) ::kill(pid_, number);
}

std::string Process::out() const { return content_of(out_path_); }
std::string Process::err() const { return content_of(err_path_); }

bool Process::wait_until(const std::function<bool()>& is_there) {
  bool is_so = false;
  const bool is_settled = server::eventually([&] {
    const bool has_ended = reap(false);
    is_so = is_there();
    return is_so || has_ended;
  });
  return is_settled && is_so;
}

bool Process::wait_for(const std::string& text) {
  return wait_until([&] { return rest_of_line_in(out(), text).has_value() || rest_of_line_in(err(), text).has_value(); });
}

std::string Process::rest_of_line(const std::string& prefix) {
  std::optional<std::string> rest;
  EXPECT_TRUE(wait_until([&] { return (rest = rest_of_line_in(out(), prefix)).has_value(); }))
      << "no line with " << prefix << ": " << out() << err();
  return rest.value_or("");
}

Finished Process::finish() {
  reap(true);
  if (pid_ <= 0) return {};
  if (WIFSIGNALED(status_) && WTERMSIG(status_) != sent_) {
    ADD_FAILURE() << "ended by " << strsignal(WTERMSIG(status_)) << ": " << out() << err();
  }
  return {WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_), out(), err()};
}

Finished run(const std::vector<std::string>& arguments, const std::string& program) {
  return Process(arguments, program).finish();
}

}  // namespace curvecast::cli
