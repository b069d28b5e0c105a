#include "server/session/session_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "server/session/session_jobs.h"

namespace curvecast::server {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::shared_ptr<const Session> make_session(const std::string& id, std::size_t floats = 1) {
  auto session = std::make_shared<Session>();
  session->id = id;
  auto curve = std::make_shared<SurfaceCurve>();
  curve->x.resize(floats);
  session->revisions->publish(std::move(curve));
  return session;
}

SessionTable::Entry ready(const std::string& id, std::size_t floats = 1) {
  return {.info = {.id = id, .session = make_session(id, floats)}};
}

std::vector<std::string> ids_of(const SessionTable::Sessions& sessions) {
  std::vector<std::string> ids;
  for (const auto& session : sessions) ids.push_back(session->id);
  return ids;
}

TEST(SessionTable, FindsWhatIsThere) {
  SessionTable table({});
  table.insert(ready("a"));
  ASSERT_NE(table.find("a"), nullptr);
  EXPECT_EQ(table.find("a")->info.id, "a");
  EXPECT_EQ(table.find("b"), nullptr);
  EXPECT_EQ(table.use("b"), nullptr);
  EXPECT_EQ(table.take("a").info.session->id, "a");
  EXPECT_EQ(table.find("a"), nullptr);
}

TEST(SessionTable, SaysHowFarASessionIs) {
  SessionTable table({});
  const auto job = std::make_shared<SessionJob>();
  table.insert({.info = {.id = "a"}, .job = job});
  EXPECT_EQ(SessionTable::info_of(*table.find("a")).state, SessionState::kQueued);
  EXPECT_THAT(table.jobs(), ElementsAre(job));
  job->has_begun = true;
  EXPECT_EQ(SessionTable::info_of(*table.find("a")).state, SessionState::kPreprocessing);
  table.find("a")->job = nullptr;
  EXPECT_EQ(table.list("", 1).front().state, SessionState::kReady);
  EXPECT_THAT(table.jobs(), IsEmpty());
}

TEST(SessionTable, MakesRoomForOneMore) {
  SessionTable table({.sessions = 3});
  for (const char* id : {"a", "b", "c"}) table.insert(ready(id));
  table.use("a");
  SessionTable::Sessions evicted;
  EXPECT_TRUE(table.make_room(evicted).ok());
  EXPECT_THAT(ids_of(evicted), ElementsAre("b"));
  const std::shared_ptr<const Session> held = table.find("c")->info.session;
  table.find("a")->info.pinned = true;
  table.insert({.info = {.id = "d"}, .job = std::make_shared<SessionJob>()});
  evicted.clear();
  EXPECT_EQ(table.make_room(evicted).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(evicted, IsEmpty());
}

TEST(SessionTable, EvictsWhatHasGrownTooMuch) {
  SessionTable table({.sessions = 10, .bytes = 100'000});
  for (const char* id : {"a", "b"}) table.insert(ready(id, 15'000));
  EXPECT_GE(table.memory_bytes(), 120'000u);
  EXPECT_THAT(ids_of(table.evict_excess()), ElementsAre("a"));
  EXPECT_THAT(table.evict_excess(), IsEmpty());
  EXPECT_GE(table.memory_bytes(), 60'000u);
}

TEST(SessionTable, PinsHalfOfTheLimitsAtMost) {
  SessionTable table({.sessions = 4, .bytes = 200'000});
  for (const char* id : {"a", "b", "c"}) table.insert(ready(id));
  const auto small = make_session("small"), large = make_session("large", 30'000);
  EXPECT_TRUE(table.may_pin(*small).ok());
  EXPECT_EQ(table.may_pin(*large).code(), absl::StatusCode::kResourceExhausted);
  table.find("a")->info.pinned = true;
  EXPECT_TRUE(table.may_pin(*small).ok());
  table.find("b")->info.pinned = true;
  EXPECT_EQ(table.may_pin(*small).code(), absl::StatusCode::kResourceExhausted);
}

TEST(SessionTable, TakesOutWhatNobodyHasUsedForItsTimeToLive) {
  SessionTable table({});
  for (const char* id : {"a", "b", "c"}) table.insert(ready(id));
  for (const char* id : {"a", "b"}) table.find(id)->info.time_to_live = 100;
  const auto now = SessionTable::Clock::now();
  EXPECT_THAT(table.take_unused(now + seconds(50)), IsEmpty());
  {
    const std::shared_ptr<const Session> held = table.find("a")->info.session;
    const SessionTable::Sessions taken = table.take_unused(now + seconds(200));
    ASSERT_EQ(taken.size(), 1u);
    EXPECT_EQ(table.find("b"), nullptr);
    EXPECT_THAT(table.used_since(now + seconds(200)), ElementsAre("a"));
  }
  EXPECT_THAT(table.take_unused(now + seconds(250)), IsEmpty()) << "a was used until 200";
  EXPECT_THAT(table.used_since(now + seconds(201)), IsEmpty());
  EXPECT_EQ(table.take_unused(now + seconds(301)).size(), 1u);
}

TEST(SessionTable, WhatIsNotSavedYetStays) {
  std::set<std::string> unsaved = {"a", "b"};
  SessionTable table({.sessions = 3}, [&](const std::string& id) { return unsaved.contains(id); });
  for (const char* id : {"a", "b", "c"}) table.insert(ready(id));
  SessionTable::Sessions evicted;
  EXPECT_TRUE(table.make_room(evicted).ok());
  EXPECT_THAT(ids_of(evicted), ElementsAre("c"));
  table.find("a")->info.time_to_live = table.find("b")->info.time_to_live = 1;
  const auto later = SessionTable::Clock::now() + seconds(100);
  EXPECT_THAT(table.take_unused(later), IsEmpty());
  unsaved.erase("b");
  EXPECT_THAT(ids_of(table.take_unused(later)), ElementsAre("b"));
}

TEST(SessionTable, ListsById) {
  SessionTable table({});
  for (const char* id : {"c", "a", "b"}) table.insert(ready(id));
  const auto ids = [&](const std::string& after, std::size_t most) {
    std::vector<std::string> out;
    for (const SessionInfo& info : table.list(after, most)) out.push_back(info.id);
    return out;
  };
  EXPECT_THAT(ids("", 2), ElementsAre("a", "b"));
  EXPECT_THAT(ids("a", 9), ElementsAre("b", "c"));
  EXPECT_THAT(ids("c", 9), IsEmpty());
}

}  // namespace
}  // namespace curvecast::server
