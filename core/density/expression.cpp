#include "core/density/expression.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
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

absl::Status wrong(const std::string& text, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat("expression density '", text, "': ", why));
}

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

/// Says whether the parser already means something by the name.
bool is_reserved(const mu::Parser& parser, const std::string& name) {
  return parser.GetFunDef().contains(name) || parser.GetConst().contains(name);
}

/// For names whose meaning is not known yet.
double* any_variable(const char*, void* slots) { return &static_cast<std::deque<double>*>(slots)->emplace_back(1.0); }

std::string names_of(const std::vector<Variable>& variables) {
  std::string names;
  for (const Variable& variable : variables) absl::StrAppend(&names, names.empty() ? "" : ", ", variable.name);
  return names;
}

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

absl::Status evaluate_expression(const SurfaceCurve& curve, const std::string& text, std::span<float> values) {
  if (absl::Status status = check_expression(text); !status.ok()) return status;
  std::vector<Variable> variables = variables_of(curve);
  absl::Status known = with_parser(text, [&] {
    mu::Parser parser;
    std::erase_if(variables, [&](const Variable& variable) { return is_reserved(parser, variable.name); });
    parser.SetExpr(text);
    std::vector<Variable> used;
    for (const auto& [name, slot] : parser.GetUsedVar()) {
      const auto variable =
          std::find_if(variables.begin(), variables.end(), [&, n = name](const Variable& v) { return v.name == n; });
      if (variable == variables.end()) {
        throw mu::ParserError(absl::StrCat("there is no '", name, "'; there are: ", names_of(variables)));
      }
      used.push_back(*variable);
    }
    variables = std::move(used);
  });
  if (!known.ok()) return known;
  Mutex mutex;
  absl::Status status;
  // One by one: the parser's own way to do many at once brings threads of its own.
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), kGrain), [&](const auto& range) {
    const absl::Status done = with_parser(text, [&] {
      std::vector<double> slots(variables.size());
      mu::Parser parser;
      for (std::size_t v = 0; v < variables.size(); ++v) parser.DefineVar(variables[v].name, &slots[v]);
      parser.SetExpr(text);
      for (std::size_t l = range.begin(); l < range.end(); ++l) {
        for (std::size_t v = 0; v < variables.size(); ++v) slots[v] = variables[v].at(l);
        values[l] = static_cast<float>(parser.Eval());
      }
    });
    if (done.ok()) return;
    const MutexLock lock(mutex);
    status = done;
  });
  return status;
}

}  // namespace curvecast
