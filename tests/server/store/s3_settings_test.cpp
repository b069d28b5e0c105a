#include "server/store/s3_settings.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <map>

#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::curvecast::testing::TemporaryFolder;
using ::curvecast::testing::write_file;
using ::testing::HasSubstr;
using ::testing::Not;

Environment environment_of(const std::map<std::string, std::string>& variables) {
  return [variables](const std::string& name) {
    const auto it = variables.find(name);
    return it == variables.end() ? std::string() : it->second;
  };
}

absl::StatusOr<S3Endpoint> endpoint_of(const std::map<std::string, std::string>& variables,
                                       const std::string& bucket = "meshes") {
  return find_s3_endpoint(bucket, environment_of(variables));
}

std::string url_of(const std::map<std::string, std::string>& variables, const std::string& bucket = "meshes") {
  const auto endpoint = endpoint_of(variables, bucket);
  return endpoint.ok() ? endpoint->url : endpoint.status().ToString();
}

TEST(S3Endpoint, IsAmazonsUnlessToldOtherwise) {
  EXPECT_EQ(url_of({}), "https://meshes.s3.us-east-1.amazonaws.com");
  EXPECT_EQ(url_of({{"AWS_DEFAULT_REGION", "eu-west-1"}}), "https://meshes.s3.eu-west-1.amazonaws.com");
  EXPECT_EQ(url_of({{"AWS_REGION", "eu-west-2"}, {"AWS_DEFAULT_REGION", "eu-west-1"}}),
            "https://meshes.s3.eu-west-2.amazonaws.com");
  EXPECT_EQ(url_of({{"AWS_REGION", "cn-north-1"}}), "https://meshes.s3.cn-north-1.amazonaws.com.cn");
  EXPECT_EQ(url_of({}, "my.meshes"), "https://s3.us-east-1.amazonaws.com/my.meshes") << "no certificate has that name";
  EXPECT_EQ(endpoint_of({{"AWS_CA_BUNDLE", "/ca.pem"}})->ca_bundle, "/ca.pem");
}

TEST(S3Endpoint, OfItsOwnHasTheBucketInThePath) {
  EXPECT_EQ(url_of({{"AWS_ENDPOINT_URL", "http://minio:9000"}}), "http://minio:9000/meshes");
  EXPECT_EQ(url_of({{"AWS_ENDPOINT_URL", "http://minio:9000"}, {"AWS_ENDPOINT_URL_S3", "https://s3.example.org/gate/"}}),
            "https://s3.example.org/gate/meshes");
  EXPECT_EQ(endpoint_of({{"AWS_ENDPOINT_URL", "http://minio:9000"}})->region, "us-east-1");
}

TEST(S3Endpoint, ReadsTheProfileOfTheConfigFile) {
  const TemporaryFolder home;
  std::filesystem::create_directory(home / ".aws");
  write_file(home / ".aws/config",
             "# mine\n[default]\nregion = eu-north-1\n[profile other]\n endpoint_url=http://other:1\nREGION=mars-1\n");
  EXPECT_EQ(url_of({{"HOME", home.path()}}), "https://meshes.s3.eu-north-1.amazonaws.com");
  EXPECT_EQ(url_of({{"HOME", home.path()}, {"AWS_PROFILE", "other"}}), "http://other:1/meshes");
  EXPECT_EQ(endpoint_of({{"HOME", home.path()}, {"AWS_PROFILE", "other"}})->region, "mars-1");
  EXPECT_EQ(url_of({{"HOME", home.path()}, {"AWS_REGION", "eu-west-1"}}), "https://meshes.s3.eu-west-1.amazonaws.com");
  EXPECT_EQ(url_of({{"AWS_CONFIG_FILE", home / ".aws/config"}}), "https://meshes.s3.eu-north-1.amazonaws.com");
}

TEST(S3Endpoint, RefusesWhatIsNone) {
  for (const char* bucket : {"", "ab", "Meshes", "a/b", "-meshes", "meshes.", "me_shes", "me shes", "m\n\n"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(endpoint_of({}, bucket).status())) << bucket;
  }
  EXPECT_TRUE(absl::IsInvalidArgument(endpoint_of({}, std::string(64, 'a')).status()));
  for (const char* url :
       {"minio:9000", "ftp://minio", "http://user:hush@minio", "http://minio?x", "http://mi nio", "http://a\r\nb"}) {
    const absl::Status status = endpoint_of({{"AWS_ENDPOINT_URL", url}}).status();
    EXPECT_TRUE(absl::IsFailedPrecondition(status)) << url;
    EXPECT_THAT(status.message(), Not(HasSubstr("hush")));
  }
  for (const char* region : {"eu:west", "eu west", "eu/west"}) {
    EXPECT_TRUE(absl::IsFailedPrecondition(endpoint_of({{"AWS_REGION", region}}).status())) << region;
  }
}

TEST(S3KeySource, TakesTheEnvironmentBeforeFiles) {
  const TemporaryFolder folder;
  write_file(folder / "credentials", "[default]\naws_access_key_id = FILE\naws_secret_access_key = filed\n");
  std::map<std::string, std::string> variables = {{"AWS_SHARED_CREDENTIALS_FILE", folder / "credentials"}};
  EXPECT_EQ((*S3KeySource::open(environment_of(variables)))->keys(), (S3Keys{"FILE", "filed", ""}));
  variables["AWS_ACCESS_KEY_ID"] = "ENV";
  EXPECT_TRUE(absl::IsFailedPrecondition(S3KeySource::open(environment_of(variables)).status())) << "one half";
  variables["AWS_SECRET_ACCESS_KEY"] = "environed";
  variables["AWS_SESSION_TOKEN"] = "token";
  EXPECT_EQ((*S3KeySource::open(environment_of(variables)))->keys(), (S3Keys{"ENV", "environed", "token"}));
}

TEST(S3KeySource, FindsAProfileAsOthersWriteIt) {
  const TemporaryFolder folder;
  write_file(folder / "credentials",
             "; keys\r\n[default]\r\naws_access_key_id=NOT\r\n\r\n[ minio ]\r\n aws_access_key_id =  AK1 \r\n"
             "aws_secret_access_key=a/b+c=d==\r\naws_session_token = t\r\n[last]\naws_access_key_id=NOR\n");
  const auto source =
      S3KeySource::open(environment_of({{"AWS_SHARED_CREDENTIALS_FILE", folder / "credentials"}, {"AWS_PROFILE", "minio"}}));
  ASSERT_TRUE(source.ok()) << source.status();
  EXPECT_EQ((*source)->keys(), (S3Keys{"AK1", "a/b+c=d==", "t"}));
}

TEST(S3KeySource, SaysWhereItLookedAndNotWhatItFound) {
  const TemporaryFolder folder;
  const std::string file = folder / "credentials";
  const Environment environment = environment_of({{"AWS_SHARED_CREDENTIALS_FILE", file}, {"AWS_PROFILE", "mine"}});
  for (const char* text : {"", "[default]\naws_secret_access_key=hush\n", "[mine]\naws_secret_access_key=hush\n",
                           "[mine]\naws_access_key_id=A\naws_secret_access_key=hush hush\n"}) {
    write_file(file, text);
    const absl::Status status = S3KeySource::open(environment).status();
    EXPECT_TRUE(absl::IsFailedPrecondition(status)) << text;
    EXPECT_THAT(status.message(), HasSubstr(file));
    EXPECT_THAT(status.message(), HasSubstr("'mine'"));
    EXPECT_THAT(status.message(), Not(HasSubstr("hush")));
  }
  EXPECT_TRUE(absl::IsFailedPrecondition(S3KeySource::open(environment_of({})).status())) << "nobody's home";
}

TEST(S3KeySource, ReadsAFileAnewWhenItChanges) {
  const TemporaryFolder folder;
  const std::string file = folder / "credentials";
  const auto put = [&](const std::string& key) {
    write_file(file + ".new", "[default]\naws_access_key_id=" + key + "\naws_secret_access_key=s\n");
    std::filesystem::rename(file + ".new", file);
  };
  put("FIRST");
  const auto source = *S3KeySource::open(environment_of({{"AWS_SHARED_CREDENTIALS_FILE", file}}));
  EXPECT_EQ(source->keys().access_key, "FIRST");
  put("SECOND");
  EXPECT_EQ(source->keys().access_key, "SECOND");
  write_file(file, "[default]\n");
  EXPECT_EQ(source->keys().access_key, "SECOND") << "half-written";
  std::filesystem::remove(file);
  EXPECT_EQ(source->keys().access_key, "SECOND");
  put("THIRD");
  EXPECT_EQ(source->keys().access_key, "THIRD");
}

TEST(S3KeySource, HasOthersForThoseThatWereRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "credentials";
  const auto put = [&](const std::string& key) {
    write_file(file, "[default]\naws_access_key_id=" + key + "\naws_secret_access_key=s\n");
  };
  put("A");
  const auto time = std::filesystem::last_write_time(file);
  const auto source = *S3KeySource::open(environment_of({{"AWS_SHARED_CREDENTIALS_FILE", file}}));
  const S3Keys first = source->keys();
  EXPECT_EQ(source->keys_instead_of(first), std::nullopt) << "there are no others";
  put("B");
  std::filesystem::last_write_time(file, time);  // a clock too coarse to tell, and the same size
  ASSERT_EQ(source->keys_instead_of(first)->access_key, "B");
  EXPECT_EQ(source->keys_instead_of(first)->access_key, "B") << "another caller with the old ones";
  EXPECT_EQ(source->keys_instead_of(source->keys()), std::nullopt);
  const auto fixed = *S3KeySource::open(environment_of({{"AWS_ACCESS_KEY_ID", "E"}, {"AWS_SECRET_ACCESS_KEY", "s"}}));
  EXPECT_EQ(fixed->keys_instead_of(fixed->keys()), std::nullopt);
}

}  // namespace
}  // namespace curvecast::server
