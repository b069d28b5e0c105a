#include "client/lib/draco/symbol_reader.h"

#include <draco/compression/entropy/symbol_encoding.h>
#include <draco/core/encoder_buffer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace curvecast::client {
namespace {

/// Mostly small ones, as differences are; `spread` is their typical size.
std::vector<std::uint32_t> symbols_of(std::size_t count, double spread) {
  std::mt19937 random(static_cast<unsigned>(spread));
  std::vector<std::uint32_t> symbols(count);
  for (std::uint32_t& symbol : symbols) {
    symbol = static_cast<std::uint32_t>(-spread * std::log((random() + 1.0) / 4294967297.0));
  }
  return symbols;
}

enum class Scheme { kTagged, kRaw };

/// As an attribute has them: a flag, then the symbols.
std::string encode(const std::vector<std::uint32_t>& symbols, int components, Scheme scheme) {
  draco::Options options;
  draco::SetSymbolEncodingMethod(&options, scheme == Scheme::kRaw ? draco::SYMBOL_CODING_RAW : draco::SYMBOL_CODING_TAGGED);
  draco::EncoderBuffer buffer;
  buffer.Encode(std::uint8_t{1});
  EXPECT_TRUE(draco::EncodeSymbols(symbols.data(), static_cast<int>(symbols.size()), components, &options, &buffer));
  return {buffer.data(), buffer.size()};
}

/// All of them, in parts of uneven lengths; empty when they are refused.
std::vector<std::uint32_t> decode(SymbolReader& reader, std::string_view bytes, std::size_t points, std::size_t components) {
  ByteReader front(bytes);
  if (!reader.open(front, points, components).ok()) return {};
  std::vector<std::uint32_t> symbols(points * components);
  for (std::size_t begin = 0, part = 1; begin < points; begin += part, part = part * 3 % 1000 + 1) {
    part = std::min(part, points - begin);
    reader.read(part, symbols.data() + begin * components);
  }
  EXPECT_TRUE(front.left().empty());
  return reader.had_enough() ? symbols : std::vector<std::uint32_t>();
}

// Spreads that need every table: narrow, wide and searched.
TEST(SymbolReader, ReadsWhatDracoEncodes) {
  SymbolReader reader;
  for (const double spread : {0.1, 3.0, 30.0, 300.0, 3000.0, 30'000.0}) {
    for (const int components : {1, 2, 3, 4}) {
      for (const Scheme scheme : {Scheme::kTagged, Scheme::kRaw}) {
        const std::vector<std::uint32_t> symbols = symbols_of(5000 * components, spread);
        const std::string bytes = encode(symbols, components, scheme);
        EXPECT_EQ(decode(reader, bytes, 5000, components), symbols) << spread << ", " << components;
      }
    }
  }
}

TEST(SymbolReader, ReadsThreeStreamsTogether) {
  const auto a = symbols_of(3000, 2000), b = symbols_of(2000, 300), c = symbols_of(1000, 0.5);
  const std::string bytes[] = {encode(a, 3, Scheme::kRaw), encode(b, 2, Scheme::kRaw), encode(c, 1, Scheme::kRaw)};
  SymbolReader readers[3];
  for (std::size_t i = 0; i < 3; ++i) {
    ByteReader front(bytes[i]);
    ASSERT_TRUE(readers[i].open(front, 1000, 3 - i).ok());
    ASSERT_NE(readers[i].entropy(), nullptr);
  }
  std::vector<std::uint32_t> to_a(3000), to_b(2000), to_c(1000);
  for (const auto& [begin, count] : {std::pair{0, 1}, std::pair{1, 600}, std::pair{601, 399}}) {
    RansReader::read_together({readers[0].entropy(), readers[1].entropy(), readers[2].entropy()}, static_cast<std::size_t>(count),
                              {to_a.data() + 3 * begin, to_b.data() + 2 * begin, to_c.data() + begin});
  }
  EXPECT_EQ(to_a, a);
  EXPECT_EQ(to_b, b);
  EXPECT_EQ(to_c, c);
  for (const SymbolReader& reader : readers) EXPECT_TRUE(reader.had_enough());
}

TEST(SymbolReader, ReadsPlainBytes) {
  SymbolReader reader;
  const std::string bytes("\0\x02\x01\x00\xff\x80\x03\x01", 8);  // two bytes each
  EXPECT_EQ(decode(reader, bytes, 3, 1), (std::vector<std::uint32_t>{1, 0x80ff, 0x103}));
  EXPECT_EQ(decode(reader, std::string("\0\0", 2), 3, 1), (std::vector<std::uint32_t>{0, 0, 0}));
}

TEST(SymbolReader, RefusesWhatIsBroken) {
  SymbolReader reader;
  const std::vector<std::uint32_t> symbols = symbols_of(300, 20);
  for (const Scheme scheme : {Scheme::kTagged, Scheme::kRaw}) {
    const std::string bytes = encode(symbols, 3, scheme);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ByteReader front(std::string_view(bytes).substr(0, size));
      EXPECT_FALSE(reader.open(front, 100, 3).ok()) << size;
    }
  }
  EXPECT_TRUE(decode(reader, std::string("\0\x05", 2), 1, 1).empty());      // five bytes each
  EXPECT_TRUE(decode(reader, "\x01\x02", 1, 1).empty());                    // a third scheme
  EXPECT_TRUE(decode(reader, std::string("\x01\x01\0", 3), 1, 1).empty());  // no bits
  EXPECT_TRUE(decode(reader, "\x01\x01\x13", 1, 1).empty());                // 19 bits
}

TEST(SymbolReader, NoticesMoreSymbolsThanThereAre) {
  SymbolReader reader;
  const std::string bytes = encode(symbols_of(1000, 20), 1, Scheme::kRaw);
  ByteReader front(bytes);
  ASSERT_TRUE(reader.open(front, 1200, 1).ok());
  std::vector<std::uint32_t> symbols(1200);
  reader.read(1200, symbols.data());
  EXPECT_FALSE(reader.had_enough());
}

}  // namespace
}  // namespace curvecast::client
