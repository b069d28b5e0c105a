// The program that `curvecast bench` runs. `curvecast-bench ...` is `curvecast bench ...`.
#include <CLI/CLI.hpp>
#include <vector>

#include "client/bench/bench_command.h"
#include "client/cli/program.h"

int main(int argc, char** argv) {
  using namespace curvecast::cli;
  std::vector<const char*> words(argv, argv + argc);
  words.insert(words.begin() + 1, "bench");
  return run_program(static_cast<int>(words.size()), words.data(), [](CLI::App& root, CommonOptions& options) {
    return std::vector<Command>{bench::add_benchmarks(root, options)};
  });
}
