#include "core/codec/byte_writer.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace curvecast {
namespace {

TEST(ByteWriter, PutsTheLowestByteFirst) {
  ByteWriter bytes;
  bytes.put(std::uint32_t{0x04030201});
  bytes.put_byte(5);
  bytes.put_bytes(std::array<std::uint8_t, 2>{6, 7});
  EXPECT_EQ(bytes.size(), 7u);
  EXPECT_EQ(std::move(bytes).take(), "\x01\x02\x03\x04\x05\x06\x07");
}

TEST(ByteWriter, PutsSevenBitsOfANumberInAByte) {
  const auto varint = [](std::uint64_t value) {
    ByteWriter bytes;
    bytes.put_varint(value);
    return std::move(bytes).take();
  };
  EXPECT_EQ(varint(0), std::string("\0", 1));
  EXPECT_EQ(varint(127), "\x7f");
  EXPECT_EQ(varint(128), "\x80\x01");
  EXPECT_EQ(varint(300), "\xac\x02");
  EXPECT_EQ(varint(~std::uint64_t{0}), "\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01");
}

}  // namespace
}  // namespace curvecast
