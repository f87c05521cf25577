// Tests the data about a participant in a study: pseudonym, consent, handedness and body.
#include "scenario/participant.h"

#include <gtest/gtest.h>

#include "fixture.h"
#include "scenario/pseudonym.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

constexpr const char* kGood =
    "pseudonym: K7QM2XPX\nconsent: {version: study-2, date: 2024-02-29}\n";

class Participant : public testing::Test {
 protected:
  ParticipantFile Load(const std::string& text) const {
    std::ofstream(folder_ / "p07.yaml") << text;
    return LoadParticipant(folder_ / "p07.yaml");
  }
  std::string Error(const std::string& text) const {
    try {
      Load(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::string Error(const std::string& pseudonym, const std::string& version,
                    const std::string& date) const {
    return Error("pseudonym: \"" + pseudonym + "\"\nconsent:\n  version: \"" + version +
                 "\"\n  date: \"" + date + "\"\n");
  }
  const test::TemporaryFolder folder_;
};

TEST_F(Participant, BecomesLabelsAndComesBack) {
  const ParticipantFile person = Load(std::string(kGood) + "handedness: left\n");
  EXPECT_FALSE(person.body);
  std::map<std::string, std::string> labels = LabelsOf(person);
  for (const auto& [key, value] : labels) EXPECT_TRUE(IsParticipantLabel(key)) << key;
  EXPECT_FALSE(IsParticipantLabel("condition"));
  labels["condition"] = "real";
  const auto again = ParticipantIn(labels);
  ASSERT_TRUE(again);
  EXPECT_EQ(ParticipantWords(*again),
            "participant K7QM2XPX, consent study-2 of 2024-02-29, left-handed");
  EXPECT_EQ(ParticipantWords(Load(kGood)), "participant K7QM2XPX, consent study-2 of 2024-02-29");
  EXPECT_EQ(ParticipantWords(Load(std::string(kGood) + "handedness: ambidextrous")),
            "participant K7QM2XPX, consent study-2 of 2024-02-29, ambidextrous");
  EXPECT_FALSE(ParticipantIn({{"condition", "real"}}));
}

TEST_F(Participant, HasTheBodyOfEachScenario) {
  const ParticipantFile person =
      Load(std::string(kGood) + "body: {height: 1.62, mass: 58.5, sex: female, forearm: 0.24}\n");
  ASSERT_TRUE(person.body);
  const Scenario scenario = Fixture({BodyOverride(*person.body)});
  ASSERT_TRUE(scenario.operator_.body);
  const BodySpec& body = *scenario.operator_.body;
  EXPECT_EQ(body.height, 1.62);
  EXPECT_EQ(body.mass, 58.5);
  EXPECT_EQ(body.sex, Sex::kFemale);
  EXPECT_EQ(body.forearm, 0.24);
  EXPECT_FALSE(body.hand);
}

TEST_F(Participant, MayNotBeNamed) {
  for (const char* name :
       {"Anna Smith", "anna@example.org", "ANNASMIT", "P07", "K7QM2XPY", "k7qm2xpx", "19900101"}) {
    const std::string error = Error(name, "study-2", "2026-11-20");
    EXPECT_NE(error.find("p07.yaml:1:"), std::string::npos) << error;
    EXPECT_NE(error.find("pseudonym is \"" + std::string(name) + "\""), std::string::npos) << error;
    EXPECT_NE(error.find("`predictor pseudonym`"), std::string::npos) << error;
  }
}

TEST_F(Participant, NeedsAPseudonym) {
  EXPECT_NE(Error("", "study-2", "2026-11-20").find("pseudonym is empty"), std::string::npos);
  EXPECT_NE(Error("handedness: left\n").find("pseudonym"), std::string::npos);
}

TEST_F(Participant, NeedsAConsentOfARealDay) {
  EXPECT_NE(Error("pseudonym: K7QM2XPX\n").find("consent"), std::string::npos);
  EXPECT_EQ(Error("K7QM2XPX", "study-2", "2026-02-28"), "");
  for (const char* date : {"2026-02-29", "2026-13-01", "2026-00-10", "2026-11-31", "20.11.2026",
                           "2026-11-2", "2026-11-020", "2026-1a-20", ""})
    EXPECT_NE(Error("K7QM2XPX", "study-2", date).find("p07.yaml:4:"), std::string::npos) << date;
  for (const char* version : {"", "who@example.org", "a text that is longer than forty characters"})
    EXPECT_NE(Error("K7QM2XPX", version, "2026-11-20").find("p07.yaml:3:"), std::string::npos)
        << version;
}

TEST_F(Participant, OfABadFileIsRefusedWithItsPlace) {
  EXPECT_NE(Error("Anna Smith\n").find("p07.yaml:1:1"), std::string::npos);
  EXPECT_NE(Error(std::string(kGood) + "name: Anna\n").find("p07.yaml:3:1"), std::string::npos);
  EXPECT_NE(Error(std::string(kGood) + "handedness: both\n").find("p07.yaml:3:"),
            std::string::npos);
  EXPECT_NE(
      Error(std::string(kGood) + "body: {height: 3, mass: 58, sex: female}\n").find("p07.yaml:3:"),
      std::string::npos);
}

}  // namespace
}  // namespace predictor
