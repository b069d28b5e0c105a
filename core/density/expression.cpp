#include "core/density/expression.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <muParser.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <string_view>
#include <vector>

#include "core/base/mutex.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 1 << 14;  // vertices; every task reads the formula anew
constexpr double kStepOperations = 1e6;  // some milliseconds, after which a task looks whether it is still wanted

// In additions: the parser's way into a formula, fetching a variable, and the power or function that takes longest.
constexpr double kEntryCost = 8, kVariableCost = 4, kCallCost = 16;

/// What a name stands for at curve vertex l.
struct Variable {
  std::string name;
  std::function<double(std::size_t)> at;
};

bool is_identifier(std::string_view name) {
  const auto is_letter = [](char c) { return absl::ascii_isalpha(static_cast<unsigned char>(c)) || c == '_'; };
  return !name.empty() && is_letter(name[0]) && std::all_of(name.begin(), name.end(), [&](char c) {
    return is_letter(c) || absl::ascii_isdigit(static_cast<unsigned char>(c));
  });
}

std::vector<Variable> variables_of(const SurfaceCurve& curve) {
  const auto number = [](const auto& column) {
    return [&column](std::size_t l) { return static_cast<double>(float{column[l]}); };
  };
  const auto k1 = number(curve.curvature_min), k2 = number(curve.curvature_max);
  std::vector<Variable> variables = {
      {"x", [&](std::size_t l) { return curve.origin.x() + static_cast<double>(curve.x[l]); }},
      {"y", [&](std::size_t l) { return curve.origin.y() + static_cast<double>(curve.y[l]); }},
      {"z", [&](std::size_t l) { return curve.origin.z() + static_cast<double>(curve.z[l]); }},
      {"nx", number(curve.nx)},
      {"ny", number(curve.ny)},
      {"nz", number(curve.nz)},
      {"gauss", [k1, k2](std::size_t l) { return k1(l) * k2(l); }},
      {"mean", [k1, k2](std::size_t l) { return (k1(l) + k2(l)) / 2; }},
      {"k1", k1},
      {"k2", k2},
  };
  for (const ScalarColumn& scalar : curve.scalars) {
    const bool is_taken =
        std::any_of(variables.begin(), variables.end(), [&](const Variable& other) { return other.name == scalar.name; });
    if (is_identifier(scalar.name) && !is_taken) variables.push_back({scalar.name, number(scalar.values)});
  }
  return variables;
}

/// Of a long formula the beginning, so that the reason is not cut off on its way to the client.
std::string about(const std::string& text, const std::string& why) {
  constexpr std::size_t kMost = 64;
  return absl::StrCat("expression density '", text.substr(0, kMost), text.size() > kMost ? "..." : "", "': ", why);
}

absl::Status wrong(const std::string& text, const std::string& why) { return absl::InvalidArgumentError(about(text, why)); }

/// What is wrong without reading it; the parser would take an assignment.
absl::Status check_text(const std::string& text) {
  if (text.empty()) return absl::InvalidArgumentError("expression density: the formula is empty");
  if (text.size() > kMaxExpression) {
    return absl::InvalidArgumentError(
        absl::StrCat("expression density: the formula has ", text.size(), " bytes; at most ", kMaxExpression, " are taken"));
  }
  if (!std::all_of(text.begin(), text.end(), [](char c) { return absl::ascii_isprint(static_cast<unsigned char>(c)); })) {
    return absl::InvalidArgumentError("expression density: the formula holds a byte that is no printable ASCII character");
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    const bool is_second = i > 0 && std::string_view("=<>!").find(text[i - 1]) != std::string_view::npos;
    const bool is_first = i + 1 < text.size() && text[i + 1] == '=';
    if (!is_second && !is_first) return wrong(text, "nothing can be assigned; equality is ==");
  }
  return absl::OkStatus();
}

/// Calls use(), and says what the parser found wrong.
template <typename Use>
absl::Status with_parser(const std::string& text, const Use& use) {
  try {
    use();
    return absl::OkStatus();
  } catch (const mu::ParserError& error) {
    return wrong(text, error.GetMsg());
  } catch (const std::exception& error) {
    return wrong(text, error.what());
  }
}

/// Throws where several values stand side by side.
void expect_one_value(const mu::Parser& parser) {
  if (parser.GetNumResults() != 1) throw mu::ParserError("it has several values; one is needed");
}

/// What a formula that was read takes at each place, in additions.
double operations_of(const mu::Parser& parser, std::size_t variables) {
  const mu::ParserByteCode& code = parser.GetByteCode();
  double operations = kEntryCost + kVariableCost * static_cast<double>(variables);
  for (std::size_t i = 0; i < code.GetSize(); ++i) {
    const mu::ECmdCode command = code.GetBase()[i].Cmd;
    operations += command == mu::cmPOW || command >= mu::cmFUNC ? kCallCost : 1;
  }
  return operations;
}

absl::Status check_operations(const std::string& text, double operations, std::size_t places) {
  if (operations * static_cast<double>(places) <= kMaxExpressionOperations) return absl::OkStatus();
  return wrong(text,
               absl::StrFormat("it takes %.0f operations at each of %d places; at most %.0f are done in all: shorten it, or "
                               "take a session with fewer curve vertices",
                               operations, places, kMaxExpressionOperations));
}

std::string names_of(const std::vector<Variable>& variables, const mu::Parser& parser) {
  std::string names;
  for (const Variable& variable : variables) {
    const bool is_taken = parser.GetFunDef().contains(variable.name) || parser.GetConst().contains(variable.name);
    if (!is_taken) absl::StrAppend(&names, names.empty() ? "" : ", ", variable.name);
  }
  return names;
}

/// A formula, read, with a place for each variable that it uses.
class Program {
 public:
  /// Throws mu::ParserError. `variables` must outlive this.
  Program(const std::string& text, const std::vector<Variable>& variables) : variables_(variables) {
    parser_.SetVarFactory(define, this);
    parser_.SetExpr(text);
    parser_.Eval();  // which reads it
    expect_one_value(parser_);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  double at(std::size_t l) {
    for (Slot& slot : slots_) slot.value = slot.variable->at(l);
    return parser_.Eval();
  }
  double operations() const { return operations_of(parser_, slots_.size()); }

 private:
  struct Slot {
    const Variable* variable;
    double value = 1;
  };

  /// Called by the parser for each name that means nothing to it, once.
  static double* define(const char* name, void* program) {
    auto& [variables, slots, parser] = *static_cast<Program*>(program);
    const auto variable = std::ranges::find(variables, name, &Variable::name);
    if (variable == variables.end()) {
      throw mu::ParserError(absl::StrCat("there is no '", name, "'; there are: ", names_of(variables, parser)));
    }
    return &slots.emplace_back(Slot{&*variable}).value;
  }

  const std::vector<Variable>& variables_;
  std::deque<Slot> slots_;  // which stay where they are
  mu::Parser parser_;
};

/// For names whose meaning is not known yet.
double* any_variable(const char*, void* slots) { return &static_cast<std::deque<double>*>(slots)->emplace_back(1.0); }

}  // namespace

absl::Status check_expression(const std::string& text) {
  if (absl::Status status = check_text(text); !status.ok()) return status;
  return with_parser(text, [&] {
    std::deque<double> slots;
    mu::Parser parser;
    parser.SetVarFactory(any_variable, &slots);
    parser.SetExpr(text);
    parser.Eval();
    expect_one_value(parser);
  });
}

absl::Status evaluate_expression(const SurfaceCurve& curve, const std::string& text, std::span<float> values,
                                 const ExecutionContext& context) {
  absl::Status status = check_text(text);
  if (!status.ok()) return status;
  const std::vector<Variable> variables = variables_of(curve);
  double operations = 0;
  status = with_parser(text, [&] { operations = Program(text, variables).operations(); });
  status.Update(check_operations(text, operations, values.size()));
  if (!status.ok()) return status;
  const auto step = static_cast<std::size_t>(std::max(1.0, kStepOperations / operations));
  Mutex mutex;
  // One by one: the parser's own way to do many at once brings threads of its own.
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), kGrain), [&](const auto& range) {
    if (!context.check_limit().ok()) return;
    WorkLimit::Meter meter(context.limit);
    const absl::Status done = with_parser(text, [&] {
      Program program(text, variables);
      for (std::size_t l = range.begin(); l < range.end() && context.check_limit().ok();) {
        for (const std::size_t end = std::min(l + step, range.end()); l < end; ++l) values[l] = static_cast<float>(program.at(l));
        meter.settle();
      }
    });
    if (done.ok()) return;
    const MutexLock lock(mutex);
    status = done;
  });
  if (const absl::Status left = context.check_limit(); status.ok() && !left.ok()) {
    status = absl::IsCancelled(left) ? left : absl::DeadlineExceededError(about(text, std::string(left.message())));
  }
  return status;
}

}  // namespace curvecast
