// curvecast remesh, and the files that it writes, as the command itself reads them.
#include <cmath>
#include <fstream>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;

TEST_F(CliTest, RemeshWritesFilesOfEveryKind) {
  for (const std::string ending : {".ply", ".obj", ".off", ".stl", ".glb"}) {
    const std::string path = temporary("remeshed" + ending);
    const json report = run_json({"remesh", sphere_, "-n", "1500", "-o", path});
    expect_keys(report, {"vertices", "triangles", "components", "genus", "boundary_loops", "least_angles", "seconds", "sampler",
                         "relaxations", "fit", "feature_degrees", "method", "seed", "session_id", "output"});
    EXPECT_EQ(report["vertices"], 1500);
    EXPECT_EQ(report["triangles"], 2996);
    EXPECT_GT(report["least_angles"]["median"], 45);
    json info = run_json({"info", path});
    info["mesh"].erase("crease_degrees");  // OBJ and GLB have normals
    EXPECT_EQ(info["mesh"].dump(), R"({"boundary_loops":0,"components":1,"faces":2996,"genus":0,"vertices":1500})") << ending;
    EXPECT_NEAR(info["area"].get<double>(), run_json({"info", sphere_})["area"].get<double>(), 0.1) << ending;
  }
}

TEST_F(CliTest, RemeshKeepsColoursAndPlacesFarOut) {
  // Two coloured triangles far from the origin.
  const std::string mesh = temporary("far.ply");
  std::ofstream(mesh) << "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
                         "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float heat\nelement face 2\n"
                         "property list uchar int vertex_indices\nend_header\n"
                         "5000000 7000000 0 255 0 0 1\n5000001 7000000 0 255 0 0 2\n5000001 7000001 0 255 0 0 2\n"
                         "5000000 7000001 0 255 0 0 1\n3 0 1 2\n3 0 2 3\n";
  for (const std::string ending : {".ply", ".obj", ".off", ".glb"}) {
    const std::string path = temporary("far_out" + ending);
    ASSERT_EQ(run({"remesh", mesh, "-n", "300", "--density", "uniform", "-o", path}).status, 0);
    const json info = run_json({"info", path});
    EXPECT_EQ(info["mesh"]["vertices"], 300) << ending;
    EXPECT_EQ(info["mesh"]["boundary_loops"], 1) << ending;
    EXPECT_NEAR(info["area"].get<double>(), 1, 1e-3) << ending;
    EXPECT_NEAR(info["box"]["min"][1].get<double>(), 7'000'000, 1e-3) << ending;
    EXPECT_EQ(info["attributes"].dump().find("scalar heat") != std::string::npos, ending == ".ply") << info["attributes"];
    const bool has_colours = ending != ".off";
    EXPECT_EQ(info["attributes"].dump().find("colours") != std::string::npos, has_colours) << ending << info["attributes"];
  }
}

TEST_F(CliTest, RemeshFollowsItsOptions) {
  const json dense = run_json({"remesh", sphere_, "-n", "900", "--relax", "0", "--density", "expression:1 + 20 * (z > 0)"});
  EXPECT_EQ(dense["relaxations"], 0);
  EXPECT_LT(dense["least_angles"]["percentile_1"], run_json({"remesh", sphere_, "-n", "900"})["least_angles"]["percentile_1"]);
  EXPECT_EQ(run_json({"remesh", sphere_, "-n", "900", "--sampler", "equalised"})["vertices"], 900);
  // Fitted it lies nearer to the sphere.
  const std::string plain = temporary("plain.ply"), fitted = temporary("fitted.ply");
  EXPECT_EQ(run_json({"remesh", sphere_, "-n", "300", "-o", plain})["fit"], false);
  EXPECT_EQ(run_json({"remesh", sphere_, "-n", "300", "--fit", "-o", fitted})["fit"], true);
  const auto rms = [&](const std::string& path) {
    return run_json({"measure", sphere_, "--mesh", path})["distance"]["from_mesh"]["rms"].get<double>();
  };
  EXPECT_LT(rms(fitted), 0.6 * rms(plain));
  EXPECT_EQ(run_json({"remesh", sphere_, "-n", "900", "--features", "30"})["feature_degrees"], 30);
  const json square = run_json({"remesh", sphere_, "-n", "900", "--method", "parameter"});
  EXPECT_EQ(square["method"], "parameter");
  EXPECT_EQ(square["triangles"], 1796);
  const Finished text = run({"remesh", sphere_, "-n", "900"});
  EXPECT_THAT(text.out, HasSubstr("900 vertices, 1796 triangles: 1 component, genus 0, 0 borders"));
}

TEST_F(CliTest, RemeshSaysWhatIsWrong) {
  const auto expect_error = [&](std::vector<std::string> arguments, int status, const std::string& why) {
    arguments.insert(arguments.begin(), "remesh");
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, status) << why;
    EXPECT_THAT(finished.err, HasSubstr(why));
  };
  expect_error({sphere_, "-o", "mesh.xyz"}, 2, ".ply, .obj, .off, .stl, .glb or .drc");
  expect_error({sphere_, "--relax", "101"}, 2, "--relax");
  expect_error({sphere_, "--features", "200"}, 2, "--features");
  expect_error({sphere_, "--method", "magic"}, 2, "magic");
  expect_error({sphere_, "--method", "parameter", "--features", "30"}, 3, "feature_degrees");
  expect_error({sphere_, "-n", "3"}, 3, "3 vertices are too few");
  expect_error({sphere_, "-o", "/nowhere/mesh.ply"}, 3, "/nowhere/mesh.ply");
}

}  // namespace
}  // namespace curvecast::cli
