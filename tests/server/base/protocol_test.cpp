#include "server/base/protocol.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/curve/hilbert.h"
#include "core/density/camera.h"
#include "core/mesh_io/mesh_companions.h"
#include "core/sample/point_set.h"
#include "core/sample/radius_ladder.h"
#include "server/frame/surface_file.h"

namespace curvecast::server {
namespace {

// All of them, so that none is held against nothing: a client has only what it needs.
TEST(Protocol, HasTheNumbersOfTheApi) {
  std::ifstream file(CURVECAST_PROTOCOL);
  const nlohmann::json own = {
      {"MAX_POINTS", kMaxPoints},
      {"MAX_MEASURED_POINTS", kMaxMeasuredPoints},
      {"MAX_MEASURED_SETS", kMaxMeasuredSets},
      {"MAX_NEIGHBOURS", kMaxNeighbours},
      {"MAX_NEIGHBOUR_PAIRS", kMaxNeighbourPairs},
      {"MAX_COMPANIONS", kMaxCompanions},
      {"MAX_DENSITY_TERMS", kMaxDensityTerms},
      {"MAX_DABS", kMaxDabs},
      {"MAX_CAMERAS", kMaxCameras},
      {"MAX_SURFACE_FACES", kMaxSurfaceFaces},
      {"MAX_CHUNK_BYTES", kMaxChunkBytes},
      {"MAX_FRAME_BYTES", kMaxFrameBytes},
      {"MAX_FRAMES_IN_FLIGHT", kMaxFramesInFlight},
      {"MIN_BUDGET_BYTES", kMinBudgetBytes},
      {"RADIUS_RUNGS", RadiusLadder::kRungs},
      {"RADIUS_RUNGS_PER_OCTAVE", RadiusLadder::kRungsPerOctave},
      {"MAX_CURVE_LEVEL", kMaxLevel},
      {"MAX_SOCKET_CALLS", kMaxSocketCalls},
      {"MAX_SOCKET_MESSAGE_BYTES", kMaxSocketMessageBytes},
  };
  EXPECT_EQ(own, nlohmann::json::parse(file));
}

}  // namespace
}  // namespace curvecast::server
