// `curvecast tiles`, and a server's tiles of the same points.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/client/cli_fixture.h"
#include "tests/server/web/http_client.h"

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;

class TilesTest : public CliTest {
 protected:
  static std::map<std::string, std::string> files_of(const std::string& folder) {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      files[entry.path().filename().string()] = bytes_of(entry.path().string());
    }
    return files;
  }
};

TEST_F(TilesTest, AreThoseOfAServer) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0", "--quiet"});
  const std::string address = server.rest_of_line("listening on "), http = server.rest_of_line("http on ");
  const int port = std::stoi(http.substr(http.rfind(':') + 1));
  const auto get = [&](const std::string& path) {
    const auto response = server::HttpClient(port).get(path);
    EXPECT_EQ(response.status, 200) << path << response.body;
    return response.body;
  };
  const std::string folder = temporary("tiles");
  for (const auto& [flags, query] :
       std::map<std::string, std::string>{{"", ""}, {"curvature:floor=0.3", "&density=curvature:floor=0.3&up=z"}}) {
    std::vector<std::string> command = {"tiles", sphere_, "-n", "70000", "-o", folder};
    if (!flags.empty()) command.insert(command.end(), {"--density", flags, "--up", "z"});
    const json written = run_json(command);
    EXPECT_EQ(written["points"], 70'000);
    std::map<std::string, std::string> files = files_of(folder);
    EXPECT_EQ(files.size(), written["files"]);

    const json session = run_json({"preprocess", sphere_, "-n", "70000", "--server", address});
    const std::string at = "/v1/sessions/" + session["session_id"].get<std::string>() + "/";
    std::string top = get(at + "tileset.json?n=70000" + query);
    const std::string uri = json::parse(top)["root"]["content"]["uri"], prefix = uri.substr(0, uri.rfind('/') + 1);
    // The same but for where the tiles are.
    for (std::size_t where = top.find(prefix); where != std::string::npos; where = top.find(prefix))
      top.erase(where, prefix.size());
    EXPECT_EQ(top, files.at("tileset.json"));
    files.erase("tileset.json");
    for (const auto& [name, bytes] : files) EXPECT_TRUE(get(at + prefix + name) == bytes) << name;
  }
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(TilesTest, HaveNoDensityOfACamera) {
  const std::string folder = temporary("none");
  expect_failure({"tiles", sphere_, "--density", "frustum", "-o", folder}, 3, "--density: a term depends on a camera");
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(TilesTest, ReplaceAnEarlierSetAndNothingElse) {
  const std::string folder = temporary("replaced");
  EXPECT_EQ(run_json({"tiles", sphere_, "-n", "6000", "-o", folder})["tiles"], 5);
  const json fewer = run_json({"tiles", sphere_, "-n", "2000", "-o", folder});
  EXPECT_EQ(fewer["tiles"], 1);
  EXPECT_EQ(files_of(folder).size(), 2u);
  std::ofstream(folder + "/notes.txt") << "mine";
  expect_failure({"tiles", sphere_, "-n", "2000", "-o", folder}, 3, "notes.txt, which is no tile");
  EXPECT_EQ(files_of(folder).size(), 3u);
}

}  // namespace
}  // namespace curvecast::cli
