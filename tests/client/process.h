// Runs the command under test as a process of its own.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace curvecast::cli {

struct Finished {
  int status = -1;  // exit status; 128 + signal when killed
  std::string out, err;
};

/// Standard output and error go to files, so nothing blocks. Killed when destroyed while running.
class Process {
 public:
  /// `program`: another one than the command.
  explicit Process(const std::vector<std::string>& arguments, const std::string& program = CURVECAST_COMMAND);
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  void signal(int number);
  pid_t pid() const { return pid_; }
  /// Waits until a whole line with `text` stands in standard output or standard error; false when the process ends or two minutes
  /// pass before.
  bool wait_for(const std::string& text);
  /// Waits until a whole line with `prefix` stands in standard output, where a log beside it on standard error does not count,
  /// and gives what follows there. "" and a failure of the test when the process ends or two minutes pass before.
  std::string rest_of_line(const std::string& prefix);
  /// What has been written so far.
  std::string out() const;
  std::string err() const;
  /// A failure of the test where a signal ended it that did not come from here: a crash.
  Finished finish();

 private:
  bool reap(bool block);
  /// Waits until there is one, as wait_for().
  bool wait_until(const std::function<bool()>& is_there);

  std::string out_path_, err_path_;
  pid_t pid_ = -1;
  int status_ = -1;  // as of waitpid(), once reaped
  bool running_ = true;
  int sent_ = 0;  // the last signal
};

/// Runs the command, or another program, to its end.
Finished run(const std::vector<std::string>& arguments, const std::string& program = CURVECAST_COMMAND);

}  // namespace curvecast::cli
