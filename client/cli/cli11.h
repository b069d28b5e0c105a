// CLI11's names for headers. Its own header has globals that every source compiles anew: only sources that use them include it.
#pragma once

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI
