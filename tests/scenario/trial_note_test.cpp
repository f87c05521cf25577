// Tests the note which states that a controller's library has passed its trial.
#include "scenario/trial_note.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

class TrialNotes : public testing::Test {
 protected:
  void Change(const std::string& bytes) { std::ofstream(library_) << bytes; }
  std::string Note() const {
    std::ifstream stream(TrialNoteFile(library_));
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path library_ = folder_ / "mine.so";
};

TEST_F(TrialNotes, NamesTheParametersThatPassed) {
  Change("library");
  NoteTrial(library_, "damping=4 stiffness=300", true);
  EXPECT_EQ(Note().find("mine.so (7 bytes, hash "), 0u) << Note();
  EXPECT_NE(Note().find(" with the parameters damping=4 stiffness=300\n"), std::string::npos)
      << Note();
  EXPECT_TRUE(HasPassedTrial(library_, "damping=4 stiffness=300"));
  EXPECT_TRUE(HasPassedTrial(library_, "  damping=4\t stiffness=300 "));
  for (const char* others : {"", "damping=4", "damping=4 stiffness=30", "damping=4 stiffness=3000",
                             "stiffness=300 damping=4"})
    EXPECT_FALSE(HasPassedTrial(library_, others)) << others;
}

TEST_F(TrialNotes, KeepEachListOfParameters) {
  Change("library");
  NoteTrial(library_, "damping=4", true);
  NoteTrial(library_, "damping=8", true);
  NoteTrial(library_, "", true);
  EXPECT_TRUE(HasPassedTrial(library_, "damping=4"));
  EXPECT_TRUE(HasPassedTrial(library_, "damping=8"));
  EXPECT_TRUE(HasPassedTrial(library_, ""));
  NoteTrial(library_, "damping=4", false);
  EXPECT_FALSE(HasPassedTrial(library_, "damping=4"));
  EXPECT_TRUE(HasPassedTrial(library_, "damping=8"));
  NoteTrial(library_, "damping=8", false);
  NoteTrial(library_, "", false);
  EXPECT_FALSE(std::filesystem::exists(TrialNoteFile(library_)));
}

TEST_F(TrialNotes, OfOtherBytesAreNotValidAndAreRemoved) {
  Change("library");
  NoteTrial(library_, "damping=4", true);
  Change("other library");
  EXPECT_FALSE(HasPassedTrial(library_, "damping=4"));
  NoteTrial(library_, "damping=8", true);
  EXPECT_EQ(Note().find("(7 bytes"), std::string::npos) << Note();
  Change("library");
  EXPECT_FALSE(HasPassedTrial(library_, "damping=4"));
}

TEST_F(TrialNotes, OfALibraryThatCannotBeReadAreNotValid) {
  EXPECT_FALSE(HasPassedTrial(library_, ""));
  EXPECT_THROW(NoteTrial(library_, "", true), InputError);
}

}  // namespace
}  // namespace predictor
