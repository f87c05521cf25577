// Tests the deletion of all data about one person.
#include "recording/forget.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "recording/reader.h"
#include "recording/samples.h"
#include "recording/share.h"
#include "recording/writer.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
using namespace recording_test;

constexpr const char* kPerson = "K7QM2XPX";

class Forget : public testing::Test {
 protected:
  fs::path Path(const std::string& name) const { return folder_ / name; }
  void Write(const std::string& name, const std::string& text) const {
    fs::create_directories(Path(name).parent_path());
    WriteFile(Path(name), text);
  }
  // Records a run with a marker in a compressed chunk.
  void Record(const std::string& name, const std::string& scenario, std::int64_t start,
              const std::string& marker = "") const {
    fs::create_directories(Path(name).parent_path());
    RecordingHeader header = SampleHeader();
    header.scenario_yaml = scenario;
    header.start_unix_ns = start;
    RecordingWriter writer(Path(name), header);
    for (std::uint64_t tick = 1; tick <= 200; ++tick) writer.Add(SampleTick(tick));
    if (!marker.empty()) writer.AddEvent(marker, 100);
    writer.Close();
  }
  static std::string Own() {
    return std::string("predictor: 1\noperator: {participant: {pseudonym: ") + kPerson + "}}\n";
  }
  std::vector<std::string> Found() const {
    std::vector<std::string> names;
    for (const PersonalFile& f : FindPerson(folder_.path(), kPerson).found)
      names.push_back(f.path.lexically_relative(folder_.path()).string());
    return names;
  }
  // Searches every name and every byte below the folder in another way than the program does.
  bool Remains() const {
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      if (entry.path().string().find(kPerson) != std::string::npos) return true;
      if (entry.is_regular_file() && !entry.is_symlink() &&
          ReadFile(entry.path()).find(kPerson) != std::string::npos)
        return true;
    }
    return false;
  }
  test::TemporaryFolder folder_;
};

TEST_F(Forget, LeavesNoByteAndChangesNoOtherPersonsData) {
  Record("a/run.mcap", Own(), 1'700'000'000'000'000'000);
  WriteShared(Path("a/run.mcap"), Path("for_others.mcap"));  // without the person's pseudonym
  Record("a/other.mcap", "predictor: 1\n", 1'700'000'000'000'000'001);
  Record("marked.mcap", "predictor: 1\n", 1'700'000'000'000'000'002,
         std::string(kPerson) + " felt dizzy");
  Write("a/run.html", "a report without the pseudonym");
  Write("a/run.opensim/motion.mot", "motion");
  Write("a/run.yaml", "a scenario of everybody");
  Write("a/run.A2C4E6GZ.real.survey.json", "an answer of another person");
  Write("a/running.html", "of another run");
  Write("run.csv", "in another folder");
  Write(std::string("b/run.") + kPerson + ".real.survey.json", "{}");
  Write(std::string(kPerson) + "/notes.txt", "anything");
  Write("b/table.csv", std::string("pseudonym\n") + kPerson + "\nA2C4E6GZ\n");
  // The pseudonym lies on the border of two blocks of the search.
  Write("b/big.bin", std::string((1U << 20U) - 3, 'x') + kPerson + "tail");
  fs::create_symlink(std::string("../") + kPerson, Path("b/link"));

  EXPECT_EQ(Found(), (std::vector<std::string>{
                         kPerson, "a/run.html", "a/run.mcap", "a/run.opensim", "b/big.bin",
                         "b/link", std::string("b/run.") + kPerson + ".real.survey.json",
                         "b/table.csv", "for_others.mcap", "marked.mcap"}));
  EXPECT_TRUE(Remains());
  EXPECT_TRUE(Delete(FindPerson(folder_.path(), kPerson).found).empty());
  EXPECT_FALSE(Remains());
  const PersonSearch after = FindPerson(folder_.path(), kPerson);
  EXPECT_TRUE(after.found.empty());
  EXPECT_TRUE(after.not_searched.empty());
  EXPECT_EQ(after.files, 5u);
  for (const char* kept : {"a/other.mcap", "a/run.yaml", "a/run.A2C4E6GZ.real.survey.json",
                           "a/running.html", "run.csv"})
    EXPECT_TRUE(fs::exists(Path(kept))) << kept;
}

// If the command silently skipped a file, it would claim that nothing is left.
TEST_F(Forget, ReportsFilesThatCannotBeSearched) {
  Record("cut.mcap", "predictor: 1\n", 1'700'000'000'000'000'000, "marker");
  const std::string bytes = ReadFile(Path("cut.mcap"));
  WriteFile(Path("cut.mcap"), bytes.substr(0, bytes.size() * 2 / 3));
  Write("data.zip", std::string("PK\3\4") + std::string(100, 'z'));
  Write("log.gz", "\x1f\x8b\x08 deflated");
  Write("study/.git/objects/ab", "deflated");
  Write("plain.txt", "text");
  const PersonSearch result = FindPerson(folder_.path(), kPerson);
  EXPECT_TRUE(result.found.empty());
  std::vector<std::string> names;
  for (const PersonalFile& f : result.not_searched) names.push_back(f.path.filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"cut.mcap", "data.zip", "log.gz", ".git"}));
}

TEST_F(Forget, ReportsThatAHardLinkKeepsTheContent) {
  Write("here/a.csv", kPerson);
  fs::create_hard_link(Path("here/a.csv"), Path("elsewhere.csv"));
  EXPECT_EQ(FindPerson(Path("here"), kPerson).linked.size(), 1u);
  EXPECT_TRUE(FindPerson(folder_.path(), kPerson).linked.empty());  // the search finds both links
}

TEST_F(Forget, ReportsFilesThatCouldNotBeDeleted) {
  Write("fixed/a.csv", kPerson);
  fs::permissions(folder_.path(), fs::perms::others_exec, fs::perm_options::add);
  fs::permissions(Path("fixed"), fs::perms(0555));
  const auto found = FindPerson(folder_.path(), kPerson).found;
  // The root user may delete everything, so the test uses another user.
  const uid_t user = geteuid();
  ASSERT_EQ(seteuid(user == 0 ? 65534 : user), 0);
  const auto failed = Delete(found);
  ASSERT_EQ(seteuid(user), 0);
  fs::permissions(Path("fixed"), fs::perms::owner_all);
  ASSERT_EQ(failed.size(), 1u);
  EXPECT_EQ(failed[0].path, Path("fixed/a.csv"));
}

TEST_F(Forget, RefusesATypingErrorAndAMissingFolder) {
  EXPECT_THROW(FindPerson(folder_.path(), "K7QM2XPY"), InputError);
  EXPECT_THROW(FindPerson(folder_.path(), ""), InputError);
  EXPECT_THROW(FindPerson(Path("missing"), kPerson), InputError);
  // The name of the folder itself contains the person's pseudonym.
  Write(std::string(kPerson) + "/a.txt", "");
  EXPECT_THROW(FindPerson(Path(kPerson), kPerson), InputError);
}

}  // namespace
}  // namespace predictor
