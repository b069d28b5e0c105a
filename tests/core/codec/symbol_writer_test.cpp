#include "core/codec/symbol_writer.h"

#include <draco/compression/entropy/symbol_decoding.h>
#include <draco/compression/entropy/symbol_encoding.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

std::string written(const std::vector<std::uint32_t>& symbols, int components) {
  SymbolWriter writer(symbols, components);
  code_runs(std::vector<RansRun*>{&writer.run()});
  ByteWriter bytes;
  writer.write(bytes);
  return std::move(bytes).take();
}

std::string by_draco(const std::vector<std::uint32_t>& symbols, int components) {
  draco::Options options;
  draco::SetSymbolEncodingCompressionLevel(&options, 5);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(draco::EncodeSymbols(symbols.data(), static_cast<int>(symbols.size()), components, &options, &buffer));
  return {buffer.data(), buffer.size()};
}

std::vector<std::uint32_t> decoded(const std::string& bytes, std::size_t n, int components) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 3));
  std::vector<std::uint32_t> symbols(n);
  EXPECT_TRUE(draco::DecodeSymbols(static_cast<std::uint32_t>(n), components, &buffer, symbols.data()));
  EXPECT_EQ(buffer.remaining_size(), 0);
  return symbols;
}

TEST(SymbolWriter, WritesWhatDracoWrites) {
  bool was_raw = false, was_tagged = false;
  for (const double bits : {0.0, 1.0, 3.0, 7.0, 10.0, 13.0, 17.5, 20.0}) {
    for (const double exponent : {0.2, 1.0, 2.0, 9.0}) {
      for (const int components : {1, 2, 3}) {
        for (const std::size_t points : {1u, 2u, 3u, 5u, 200u, 5000u}) {
          std::vector<std::uint32_t> symbols;
          for (std::size_t i = 0; i < points * static_cast<std::size_t>(components); ++i) {
            symbols.push_back(static_cast<std::uint32_t>(std::exp2(bits) * std::pow(random_unit(8, i), exponent)));
          }
          const std::string bytes = written(symbols, components);
          ASSERT_EQ(bytes, by_draco(symbols, components)) << bits << ", " << exponent << ", " << points << " of " << components;
          ASSERT_EQ(decoded(bytes, symbols.size(), components), symbols);
          (bytes[0] == 0 ? was_tagged : was_raw) = true;
        }
      }
    }
  }
  EXPECT_TRUE(was_raw);
  EXPECT_TRUE(was_tagged);
}

TEST(SymbolWriter, KeepsTheLargestSymbols) {
  const std::vector<std::uint32_t> symbols = {0, (1u << 31) - 1, 5, 1u << 30, 1, 0};
  EXPECT_EQ(decoded(written(symbols, 3), 6, 3), symbols);
}

// Draco has no raw way for so many, and fails.
TEST(SymbolWriter, KeepsAQuarterOfAMillionDistinctSymbols) {
  std::vector<std::uint32_t> symbols;
  for (std::uint32_t i = 0; i < 12u << 18; ++i) symbols.push_back(i % (1u << 18));
  EXPECT_EQ(decoded(written(symbols, 3), symbols.size(), 3), symbols);
}

}  // namespace
}  // namespace curvecast
