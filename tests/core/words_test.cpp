// What is told at the console is what the page tells.
#include "core/words.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace predictor {
namespace {

// The text between quotes after `key`, from `at` on.
std::string Quoted(const std::string& text, const std::string& key, std::size_t at) {
  const std::size_t begin = text.find("'", text.find(key, at)) + 1;
  return text.substr(begin, text.find("'", begin) - begin);
}

TEST(Words, OfAStopAreThoseOfThePage) {
  std::stringstream page;
  page << std::ifstream(PREDICTOR_SOURCE_DIR "/web/src/words.ts").rdbuf();
  const std::string text = page.str();
  const std::size_t causes = text.find("const kCauses");
  ASSERT_NE(causes, std::string::npos);
  for (int c = 1; c < kStopCauses; ++c) {
    TickRecord record{};
    record.cause = static_cast<StopCause>(c);
    record.cause_hand = -1;
    const std::size_t at = text.find(std::string("  ") + Name(record.cause) + ": {", causes);
    ASSERT_NE(at, std::string::npos) << Name(record.cause);
    std::string what = Quoted(text, "what:", at);
    what[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(what[0])));
    EXPECT_EQ(StopCauseWords(record), what + ".");
    const bool device = record.cause == StopCause::kDevice;
    const std::string next = device ? ", then start the program again." : ", then reset.";
    EXPECT_NE(text.find("'" + next + "'"), std::string::npos) << "the page has other words";
    EXPECT_EQ(StopAdvice(record), Quoted(text, "advice:", at) + next);
    record.state = RunState::kUnpowered;
    EXPECT_EQ(StopAdvice(record).find(Quoted(text, "advice:", at) + ". "), 0U);
    EXPECT_NE(
        StopAdvice(record).find("switched on at its own panel, and the program started again"),
        std::string::npos);
  }
}

// What was measured tells more closely what is wrong, and what to do.
TEST(Words, OfAStopGoByWhatWasMeasured) {
  struct Case {
    StopCause cause;
    Quantity quantity;
    const char *name, *what, *advice;
  };
  std::stringstream page;
  page << std::ifstream(PREDICTOR_SOURCE_DIR "/web/src/words.ts").rdbuf();
  const std::string text = page.str();
  for (const Case& c :
       {Case{StopCause::kStale, Quantity::kArmAge, "armOld", "no fresh sample of the arm",
             "Check the arm, its cable and its network, then reset."},
        Case{StopCause::kStale, Quantity::kSensorAge, "sensorOld",
             "no fresh reading of the force sensor",
             "Check the force sensor, its cable and its network, then reset."},
        Case{StopCause::kStale, Quantity::kCount, "frozen", "repeated one and the same reading",
             "and restart what repeats itself, then start the program again."},
        Case{StopCause::kSensor, Quantity::kForce, "unsteady",
             "did not read steadily while it was tared",
             "check the sensor and its cable, then reset."},
        Case{StopCause::kDevice, Quantity::kAngle, "jump", "a joint’s angle jumped",
             "do not trust this arm until its own checks pass, then start the program again."},
        Case{StopCause::kDevice, Quantity::kSpeed, "restless",
             "did not come to rest though it was told to",
             "Do not trust this arm until its own checks pass, then start the program again."}}) {
    TickRecord record{};
    record.cause = c.cause;
    record.cause_hand = 0;
    record.cause_quantity = c.quantity;
    EXPECT_NE(StopCauseWords(record).find(c.what), std::string::npos) << StopCauseWords(record);
    EXPECT_TRUE(StopAdvice(record).ends_with(c.advice)) << StopAdvice(record);
    const std::size_t at = text.find(std::string("  ") + c.name + ": {");
    ASSERT_NE(at, std::string::npos) << c.name;
    EXPECT_TRUE(StopCauseWords(record).starts_with("Left hand: " + Quoted(text, "what:", at)));
    EXPECT_TRUE(StopAdvice(record).starts_with(Quoted(text, "advice:", at)));
    EXPECT_EQ(CauseAdvice({c.cause, 0, 0, 0, c.quantity}), Quoted(text, "advice:", at));
    // That it was restarted is told where a reset might be thought to do.
    record.state = RunState::kUnpowered;
    EXPECT_NE(StopAdvice(record).find("where an arm or a sensor was restarted"), std::string::npos);
  }
}

TEST(Words, OfAStopNameHandAndNumbers) {
  TickRecord record{};
  EXPECT_EQ(StopCauseWords(record) + StopAdvice(record), "");
  record.cause = StopCause::kForce;
  record.cause_hand = 1;
  record.cause_quantity = Quantity::kForce;
  record.cause_value = 31.25;
  record.cause_limit = 30;
  EXPECT_EQ(StopCauseWords(record),
            "Right hand: the force was above its threshold (31.2 N seen, 30 N allowed).");
  EXPECT_EQ(StopAdvice(record), "Guide the handles more gently, then reset.");
}

// What takes the power off at the end of a stop that would have held is told beside its cause.
TEST(Words, OfAStopTellWhatMadeItsEndHarder) {
  TickRecord record{};
  record.state = RunState::kUnpowered;
  record.cause = StopCause::kDeadline;
  record.cause_hand = -1;
  record.cause_quantity = Quantity::kCount;
  record.cause_value = 3;
  record.cause_limit = 2;
  record.harder = ToRecord({StopCause::kStale, 0, 0.0214, 0.02, Quantity::kArmAge});
  EXPECT_EQ(StopCauseWords(record),
            "Ticks came too late (3 seen, 2 allowed). Power off was asked for because of this: "
            "Left hand: no fresh sample of the arm came in time (21.4 ms seen, 20 ms allowed).");
  EXPECT_TRUE(
      StopAdvice(record).starts_with("Close other programs on this computer. Check the "
                                     "arm, its cable and its network. An arm that lost"));
  EXPECT_FALSE(NeedsANewStart(record));
  record.harder = ToRecord({StopCause::kDevice, 1, 0.03, 0.01, Quantity::kSpeed});
  EXPECT_TRUE(NeedsANewStart(record));
  record.cause = StopCause::kStale;  // the same twice is advised once
  record.cause_quantity = Quantity::kArmAge;
  record.harder = ToRecord({StopCause::kStale, 0, 0.0214, 0.02, Quantity::kArmAge});
  record.state = RunState::kHeld;
  EXPECT_EQ(StopAdvice(record), "Check the arm, its cable and its network, then reset.");
}

// An arm's own stop may come behind the cause that held, as where it clamps a hand.
TEST(Words, OfAnArmsFaultBehindTheCauseChangeTheAdvice) {
  TickRecord record{};
  record.state = RunState::kHeld;
  record.cause = StopCause::kForce;
  record.hands[1].arm_fault = 1;  // of an arm that is absent
  EXPECT_FALSE(NeedsANewStart(record));
  EXPECT_EQ(StopAdvice(record), "Guide the handles more gently, then reset.");
  record.hands[1].present = 1;
  EXPECT_TRUE(NeedsANewStart(record));
  EXPECT_EQ(StopAdvice(record),
            "Guide the handles more gently. Look at the robot’s own panel and clear the fault "
            "there, then start the program again.");
  record.cause = StopCause::kDevice;  // the same twice is advised once
  EXPECT_EQ(StopAdvice(record),
            "Look at the robot’s own panel and clear the fault there, then start the program "
            "again.");
}

TEST(Words, OfWarningsAreToldOnceEach) {
  HandRecord hand{};
  EXPECT_TRUE(NewWarnings(0, hand, 0).empty());
  hand.warnings = 0b1010;
  hand.warning_values = {0, 0.034, 0, 3.5};
  const auto words = NewWarnings(0, hand, 0);
  ASSERT_EQ(words.size(), 2U);
  EXPECT_NE(words[0].find("3.4 % of the left sensor's readings"), std::string::npos) << words[0];
  EXPECT_NE(words[1].find("the left sensor drifts by 3.5 N a minute"), std::string::npos);
  EXPECT_EQ(NewWarnings(0b0010, hand, 0).size(), 1U);
  EXPECT_TRUE(NewWarnings(hand.warnings, hand, 0).empty());
}

TEST(Words, OfPowerThatIsKeptAreThoseOfThePage) {
  HandRecord hand{};
  hand.warnings = 1U << static_cast<unsigned>(Warning::kKeepsPower) |
                  1U << static_cast<unsigned>(Warning::kNoPowerOff);
  const auto words = NewWarnings(0, hand, 1);
  ASSERT_EQ(words.size(), 2U);
  EXPECT_NE(words[0].find("the right arm's dashboard has closed"), std::string::npos) << words[0];
  const std::string kept = " ARM STILL HAS ITS POWER",
                    now = ", though it was to be cut. PRESS THE EMERGENCY STOP.";
  EXPECT_EQ(words[1], "THE RIGHT" + kept + now);
  EXPECT_EQ(NewWarnings(0b1111, hand, 0)[1], "THE LEFT" + kept + now);
  std::stringstream page;
  page << std::ifstream(PREDICTOR_SOURCE_DIR "/web/src/words.ts").rdbuf();
  EXPECT_NE(page.str().find(kept), std::string::npos);
  EXPECT_NE(page.str().find(now), std::string::npos);
}

}  // namespace
}  // namespace predictor
