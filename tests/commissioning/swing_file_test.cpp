#include "commissioning/swing_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor::commissioning {
namespace {

Swings TwoOfSix() {
  Swings swings{6, {}};
  for (int joint = 0; joint < 2; ++joint) {
    LoopRecord record;
    record.joint = joint;
    for (int k = 0; k < 5; ++k) {
      record.u.push_back(1.0 / 3 * k - joint);
      record.samples.push_back({0.002 * k + 1e-7, 1.1 * k});
    }
    record.gaps = {5, 1, 5, 2, 0.003, 0.004};
    swings.records.push_back(record);
  }
  return swings;
}

class SwingFileTest : public testing::Test {
 protected:
  std::string Text() const {
    std::ifstream in(file_.path());
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  void Write(const std::string& text) const { std::ofstream(file_.path()) << text; }

  test::TemporaryFolder folder_;
  std::filesystem::path machine_ = folder_.path() / "lab.yaml";
  SwingFile file_{machine_, "left", "0123456789abcdef"};
};

TEST_F(SwingFileTest, ReadsWhatItWrote) {
  EXPECT_TRUE(file_.Load().swings.records.empty());
  EXPECT_EQ(file_.Load().remark, "");
  const Swings before = TwoOfSix();
  file_.Save(before, "2026-11-22T14-03-59");
  const SwingFile::Kept kept = file_.Load();
  EXPECT_EQ(kept.remark, "");
  EXPECT_EQ(kept.date, "2026-11-22T14-03-59");
  EXPECT_EQ(kept.swings.joints, 6);
  ASSERT_EQ(kept.swings.measured(), 2);
  EXPECT_FALSE(kept.swings.complete());
  for (std::size_t i = 0; i < 2; ++i) {
    const LoopRecord &a = before.records[i], &b = kept.swings.records[i];
    EXPECT_EQ(a.joint, b.joint);
    EXPECT_EQ(a.u, b.u);
    ASSERT_EQ(a.samples.size(), b.samples.size());
    for (std::size_t k = 0; k < a.samples.size(); ++k) {
      EXPECT_EQ(a.samples[k].time, b.samples[k].time);
      EXPECT_EQ(a.samples[k].q, b.samples[k].q);
    }
    EXPECT_EQ(GapsText(a.gaps), GapsText(b.gaps));
  }
  file_.Remove();
  EXPECT_TRUE(file_.Load().swings.records.empty());
}

TEST_F(SwingFileTest, IsOfNoOtherArm) {
  file_.Save(TwoOfSix(), "now");
  const SwingFile::Kept changed = SwingFile(machine_, "left", "0123456789abcdee").Load();
  EXPECT_TRUE(changed.swings.records.empty());
  EXPECT_NE(changed.remark.find("before the arm's settings in the machine file changed"),
            std::string::npos);
  EXPECT_TRUE(SwingFile(machine_, "right", "0123456789abcdef").Load().swings.records.empty());
}

TEST_F(SwingFileTest, ReadsNothingFromATruncatedFile) {
  file_.Save(TwoOfSix(), "now");
  const std::string whole = Text();
  for (std::size_t length = 0; length + 1 < whole.size(); ++length) {
    Write(whole.substr(0, length));
    const SwingFile::Kept kept = file_.Load();
    EXPECT_TRUE(kept.swings.records.empty()) << length;
    EXPECT_NE(kept.remark, "") << length;
  }
}

TEST_F(SwingFileTest, RefusesImpossibleMeasurements) {
  const auto damaged = [&](const std::string& from, const std::string& to) {
    file_.Save(TwoOfSix(), "now");
    std::string text = Text();
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << text;
    Write(text.replace(at, from.size(), to));
    return file_.Load().remark == "is damaged" && file_.Load().swings.records.empty();
  };
  EXPECT_FALSE(damaged("now", "then"));
  EXPECT_TRUE(damaged("predictor_swings 1", "predictor_swings 2"));
  EXPECT_TRUE(damaged("6 2\n", "1 2\n"));
  EXPECT_TRUE(damaged("6 2\n", "6 -1\n"));
  EXPECT_TRUE(damaged("6 2\n", "1000000 2\n"));
  EXPECT_TRUE(damaged("joint 0 5 5", "joint 1 5 5"));
  EXPECT_TRUE(damaged("joint 0 5 5", "joint 0 0 5"));
  EXPECT_TRUE(damaged("joint 0 5 5", "joint 0 99999999999 5"));
  EXPECT_TRUE(damaged("0.0020000999999999999 ", "0.9 "));  // later than the next sample
  EXPECT_TRUE(damaged("0.0020000999999999999 ", "nan "));
  EXPECT_TRUE(damaged("0.0080000999999999996 ", "1e300 "));
}

TEST_F(SwingFileTest, ReportsThePathThatCannotBeWritten) {
  const SwingFile nowhere(folder_.path() / "none" / "lab.yaml", "left", "0");
  EXPECT_THROW(nowhere.Save(TwoOfSix(), "now"), InputError);
}

}  // namespace
}  // namespace predictor::commissioning
