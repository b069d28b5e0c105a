// What an engine gives up when jobs want its memory.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>

#include "server/base/log.h"
#include "server/base/memory_budget.h"
#include "server/engine/engine.h"
#include "server/server.h"

namespace curvecast::server {
namespace {

TEST(EngineMemory, TilesGoBeforeAJobIsRefused) {
  ServerOptions options;
  options.threads = 1;
  options.memory_bytes = std::uint64_t{64} << 20;
  Engine engine(options, make_logger(false, false), nullptr);
  auto set = std::make_shared<Tileset>();
  set->files.emplace("0-0.glb", std::string(3 << 20, 'x'));
  engine.tilesets.keep(std::move(set));
  EXPECT_GT(engine.held_bytes(), std::uint64_t{3} << 20) << "they are counted";

  const std::atomic<bool> cancel = false;
  {
    MemoryBudget::Job little(engine.memory, &cancel, {.waits = false});
    ASSERT_TRUE(little.take(1 << 20, "a little").ok());
    EXPECT_GT(engine.tilesets.byte_size(), 0u) << "there was room";
  }
  MemoryBudget::Job all(engine.memory, &cancel, {.waits = false});
  const absl::Status taken = all.take(engine.memory.most() - (std::uint64_t{1} << 20), "nearly all");
  EXPECT_TRUE(taken.ok()) << taken;
  EXPECT_EQ(engine.tilesets.byte_size(), 0u);
}

}  // namespace
}  // namespace curvecast::server
