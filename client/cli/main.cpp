// The `curvecast` command.
#include "client/cli/commands.h"

#include <CLI/CLI.hpp>

#include "client/cli/program.h"

int main(int argc, char** argv) {
  using namespace curvecast::cli;
  return run_program(argc, argv, [](CLI::App& root, CommonOptions& options) {
    return std::vector<Command>{add_serve(root, options),  add_info(root, options),     add_preprocess(root, options),
                                add_sample(root, options), add_tiles(root, options),    add_batch(root, options),
                                add_stream(root, options), add_measure(root, options),  add_remesh(root, options),
                                add_render(root, options), add_sessions(root, options), add_health(root, options),
                                add_bench(root, options)};
  });
}
