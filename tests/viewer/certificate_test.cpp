#include "viewer/certificate.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor::viewer {
namespace {

namespace fs = std::filesystem;

class CertificateTest : public testing::Test {
 protected:
  static unsigned Permissions(const fs::path& file) {
    struct stat status {};
    stat(file.c_str(), &status);
    return status.st_mode & 0777;
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(CertificateTest, IsMadeOnceAndKept) {
  const std::vector<std::string> names = {"localhost", "127.0.0.1", "::1", "rig.local"};
  const Certificate made = SelfSignedCertificate(folder_ / "a" / "b", names);
  EXPECT_TRUE(made.made);
  EXPECT_EQ(made.names, names);
  EXPECT_EQ(made.fingerprint.size(), 32 * 3 - 1u);
  EXPECT_EQ(Permissions(folder_ / "a" / "b" / "viewer.key"), 0600u);
  EXPECT_EQ(Permissions(folder_ / "a" / "b" / "viewer.pem"), 0600u);
  const Certificate kept = SelfSignedCertificate(folder_ / "a" / "b", names);
  EXPECT_FALSE(kept.made);
  EXPECT_EQ(kept.fingerprint, made.fingerprint);
  EXPECT_EQ(kept.names, names);
}

TEST_F(CertificateTest, IsRenewedForANewName) {
  const Certificate first = SelfSignedCertificate(folder_, {"localhost"});
  const Certificate second = SelfSignedCertificate(folder_, {"localhost", "192.168.7.9"});
  EXPECT_TRUE(second.made);
  EXPECT_NE(first.fingerprint, second.fingerprint);
  EXPECT_FALSE(SelfSignedCertificate(folder_, {"192.168.7.9"}).made);
}

TEST_F(CertificateTest, IsRenewedWhenDamaged) {
  SelfSignedCertificate(folder_, {"localhost"});
  std::ofstream(folder_ / "viewer.key") << "garbage";
  EXPECT_TRUE(SelfSignedCertificate(folder_, {"localhost"}).made);
}

TEST_F(CertificateTest, AKeyThatOthersMayReadIsNotKept) {
  const Certificate first = SelfSignedCertificate(folder_, {"localhost"});
  chmod((folder_ / "viewer.key").c_str(), 0644);
  const Certificate second = SelfSignedCertificate(folder_, {"localhost"});
  EXPECT_TRUE(second.made);
  EXPECT_NE(first.fingerprint, second.fingerprint);
  EXPECT_EQ(Permissions(folder_ / "viewer.key"), 0600u);
}

TEST_F(CertificateTest, AFolderThatOthersMayChangeIsRefused) {
  chmod(folder_.c_str(), 0777);
  EXPECT_THROW(SelfSignedCertificate(folder_, {"localhost"}), InputError);
}

TEST_F(CertificateTest, TheUsersOwnIsChecked) {
  const Certificate made = SelfSignedCertificate(folder_, {"localhost"});
  const Certificate read = ReadCertificate(folder_ / "viewer.pem", folder_ / "viewer.key");
  EXPECT_EQ(read.fingerprint, made.fingerprint);
  EXPECT_EQ(read.names, std::vector<std::string>{"localhost"});
  EXPECT_THROW(ReadCertificate(folder_ / "none.pem", folder_ / "viewer.key"), InputError);
  EXPECT_THROW(ReadCertificate(folder_ / "viewer.key", folder_ / "viewer.key"), InputError);
  EXPECT_THROW(ReadCertificate(folder_ / "viewer.pem", folder_ / "viewer.pem"), InputError);
  SelfSignedCertificate(folder_ / "other", {"localhost"});
  EXPECT_THROW(ReadCertificate(folder_ / "viewer.pem", folder_ / "other" / "viewer.key"),
               InputError);
}

TEST_F(CertificateTest, InvalidNamesAreRefused) {
  for (const char* name : {"", "a,DNS:b", "a b", "DNS:a", "a\nb"})
    EXPECT_THROW(SelfSignedCertificate(folder_, {name}), InputError) << name;
}

TEST(MachineNames, BeginWithLoopback) {
  const std::vector<std::string> names = MachineNames();
  ASSERT_GE(names.size(), 3u);
  EXPECT_EQ(names[0], "localhost");
  EXPECT_EQ(names[1], "127.0.0.1");
}

}  // namespace
}  // namespace predictor::viewer
