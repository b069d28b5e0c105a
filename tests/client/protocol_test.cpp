#include "client/lib/protocol.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace curvecast::client {
namespace {

// tests/client/protocol.json has the table of curvecast.proto, as tests/client/python/protocol_test.py checks.
TEST(Protocol, HasTheNumbersOfTheApi) {
  std::ifstream file(CURVECAST_PROTOCOL);
  const nlohmann::json numbers = nlohmann::json::parse(file);
  EXPECT_EQ(kMaxPoints, numbers.at("MAX_POINTS"));
  EXPECT_EQ(kMaxNeighbourPairs, numbers.at("MAX_NEIGHBOUR_PAIRS"));
  EXPECT_EQ(kMaxCompanions, numbers.at("MAX_COMPANIONS"));
  EXPECT_EQ(kMaxChunkBytes, numbers.at("MAX_CHUNK_BYTES"));
  EXPECT_EQ(kMaxFrameBytes, numbers.at("MAX_FRAME_BYTES"));
  EXPECT_EQ(kRadiusRungs, numbers.at("RADIUS_RUNGS"));
  EXPECT_EQ(kRadiusRungsPerOctave, numbers.at("RADIUS_RUNGS_PER_OCTAVE"));
  EXPECT_EQ(kMaxCurveLevel, numbers.at("MAX_CURVE_LEVEL"));
}

}  // namespace
}  // namespace curvecast::client
