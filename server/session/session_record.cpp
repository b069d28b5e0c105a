#include "server/session/session_record.h"

#include <absl/strings/str_cat.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "core/storage/pipeline_archive.h"
#include "server/base/log.h"

namespace curvecast::server {

struct SessionRecord {
  std::string id, mesh_id, mesh_name, owner;
  std::vector<std::string> companions;  // name, id, name, id ...
  PreprocessOptions options;
  PreprocessReport report;
};

template <typename Archive, ConstOr<SessionRecord> T>
void archive(Archive& fields, T& record) {
  auto& [id, mesh_id, mesh_name, owner, companions, options, report] = record;
  fields(id, mesh_id, mesh_name, owner, companions, options, report);
}

std::string record_of(const Session& session) {
  SessionRecord record = {session.id, session.mesh_id, session.mesh_name,          session.owner,
                          {},         session.options, session.preprocessed.report};
  for (const auto& [name, id] : session.companions) record.companions.insert(record.companions.end(), {name, id});
  return to_archive(record);
}

absl::StatusOr<std::shared_ptr<Session>> session_of(std::string_view record, const std::string& id) {
  SessionRecord read;
  if (!from_archive(record, read) || read.companions.size() % 2 != 0) {
    return absl::DataLossError("what it says of its session makes no sense");
  }
  if (read.id != id) return absl::DataLossError(absl::StrCat("it is of session ", printable(read.id)));
  auto session = std::make_shared<Session>();
  session->id = id;
  session->mesh_id = std::move(read.mesh_id);
  session->mesh_name = std::move(read.mesh_name);
  session->owner = std::move(read.owner);
  for (std::size_t i = 0; i + 1 < read.companions.size(); i += 2)
    session->companions[read.companions[i]] = read.companions[i + 1];
  session->options = std::move(read.options);
  session->preprocessed = {nullptr, std::move(read.report), nullptr};
  return session;
}

}  // namespace curvecast::server
