#include "server/session/session_record.h"

#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

TEST(SessionRecord, SaysWhatASessionIsAndWhose) {
  Session before;
  before.id = std::string(32, 'a');
  before.mesh_id = "mesh";
  before.mesh_name = "sphere.off";
  before.owner = "anna";
  before.companions = {{"a.mtl", "1"}, {"b.png", "2"}};
  before.options.points = 200;
  before.preprocessed.report.discs = 3;
  const auto after = session_of(record_of(before), before.id);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_EQ((*after)->id, before.id);
  EXPECT_EQ((*after)->mesh_id, before.mesh_id);
  EXPECT_EQ((*after)->mesh_name, before.mesh_name);
  EXPECT_EQ((*after)->owner, before.owner);
  EXPECT_EQ((*after)->companions, before.companions);
  EXPECT_EQ((*after)->options.points, 200u);
  EXPECT_EQ((*after)->preprocessed.report.discs, 3u);
}

TEST(SessionRecord, RefusesNonsenseAndOtherSessions) {
  Session session;
  session.id = std::string(32, 'a');
  const std::string record = record_of(session);
  EXPECT_TRUE(absl::IsDataLoss(session_of(record, std::string(32, 'b')).status()));
  for (std::size_t size = 0; size < record.size(); ++size) {
    EXPECT_TRUE(absl::IsDataLoss(session_of(record.substr(0, size), session.id).status())) << size;
  }
}

}  // namespace
}  // namespace curvecast::server
