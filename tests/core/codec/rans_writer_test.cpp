#include "core/codec/rans_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

/// Probabilities as the table's bytes say.
std::vector<std::uint32_t> read_table(const RansTable& table) {
  ByteWriter writer;
  table.write(writer);
  const std::string bytes = std::move(writer).take();
  std::size_t at = 0;
  const auto next = [&] { return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at++))); };
  std::uint32_t n = 0, shift = 0, byte = 0x80;
  for (; byte >= 0x80; shift += 7) n |= ((byte = next()) & 0x7f) << shift;
  std::vector<std::uint32_t> probabilities;
  while (probabilities.size() < n) {
    const std::uint32_t first = next(), more = first & 3;
    std::uint32_t value = first >> 2;
    if (more == 3) {
      probabilities.resize(probabilities.size() + value + 1);
      continue;
    }
    for (std::uint32_t k = 0; k < more; ++k) value |= next() << (8 * k + 6);
    probabilities.push_back(value);
  }
  EXPECT_EQ(at, bytes.size());
  return probabilities;
}

/// By the textbook: the state's lowest bits say which symbol it was.
std::vector<std::uint32_t> decoded(const std::vector<std::uint32_t>& probabilities, int precision_bits,
                                   std::span<const std::uint8_t> code, std::size_t n) {
  const std::uint32_t base = 4u << precision_bits, mask = (1u << precision_bits) - 1;
  std::size_t at = code.size() - 1 - (code.back() >> 6);
  std::uint32_t state = 0;
  for (std::size_t i = code.size(); i-- > at;) state = state << 8 | (i + 1 == code.size() ? code[i] & 0x3f : code[i]);
  state += base;
  std::vector<std::uint32_t> symbols;
  while (symbols.size() < n) {
    std::uint32_t symbol = 0, start = 0;
    for (; start + probabilities[symbol] <= (state & mask); ++symbol) start += probabilities[symbol];
    state = (state >> precision_bits) * probabilities[symbol] + (state & mask) - start;
    symbols.push_back(symbol);
    while (state < base && at > 0) state = state << 8 | code[--at];
  }
  EXPECT_EQ(at, 0u);
  EXPECT_EQ(state, base);
  return symbols;
}

/// n numbers below `most`, small ones more often by the exponent.
std::vector<std::uint32_t> random_symbols(std::size_t n, double most, double exponent, std::uint64_t seed) {
  std::vector<std::uint32_t> symbols;
  for (std::size_t i = 0; i < n; ++i) {
    symbols.push_back(static_cast<std::uint32_t>(most * std::pow(random_unit(seed, i), exponent)));
  }
  return symbols;
}

std::vector<std::uint32_t> counts_of(const std::vector<std::uint32_t>& symbols) {
  std::vector<std::uint32_t> counts(*std::max_element(symbols.begin(), symbols.end()) + 1);
  for (const std::uint32_t symbol : symbols) ++counts[symbol];
  return counts;
}

TEST(RansWriter, KeepsSymbolsOfSeveralRunsAtOnce) {
  for (const int precision_bits : {12, 13, 16, 20}) {
    for (const double most : {1.0, 2.0, 40.0, 3000.0}) {
      for (const double exponent : {0.1, 1.0, 8.0}) {
        std::vector<std::vector<std::uint32_t>> symbols;
        std::vector<RansTable> tables;
        for (const std::size_t n : {500u, 1u, 2000u, 2000u, 37u}) {
          symbols.push_back(random_symbols(n, most, exponent, symbols.size()));
          tables.emplace_back(counts_of(symbols.back()), precision_bits);
        }
        std::vector<RansRun> runs;
        std::vector<RansRun*> pointers;
        for (std::size_t i = 0; i < symbols.size(); ++i) runs.push_back({.table = &tables[i], .symbols = symbols[i]});
        for (RansRun& run : runs) pointers.push_back(&run);
        code_runs(pointers);
        for (std::size_t i = 0; i < symbols.size(); ++i) {
          const std::vector<std::uint32_t> probabilities = read_table(tables[i]);
          ASSERT_EQ(decoded(probabilities, precision_bits, runs[i].code(), symbols[i].size()), symbols[i])
              << precision_bits << " bits, " << most << "^" << exponent << ", run " << i;
        }
      }
    }
  }
}

TEST(RansWriter, ProbabilitiesAddUpAndFollowTheCounts) {
  for (const double exponent : {0.05, 0.5, 1.0, 3.0, 20.0}) {
    const std::vector<std::uint32_t> counts = counts_of(random_symbols(30'000, 3500, exponent, 7));
    const std::vector<std::uint32_t> probabilities = read_table(RansTable(counts, 12));
    ASSERT_EQ(probabilities.size(), counts.size());
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      ASSERT_EQ(probabilities[i] > 0, counts[i] > 0) << i;
      sum += probabilities[i];
    }
    EXPECT_EQ(sum, 4096u);
  }
}

TEST(RansWriter, OneSymbolAloneCostsNothing) {
  const std::vector<std::uint32_t> symbols(1000, 3);
  const RansTable table(counts_of(symbols), 12);
  RansRun run{.table = &table, .symbols = symbols};
  code_runs(std::vector<RansRun*>{&run});
  EXPECT_EQ(run.size, 1u);
  code_runs({});
}

}  // namespace
}  // namespace curvecast
