// What is told at the console, by the records that a run writes.
#include "safety/console_words.h"

#include <gtest/gtest.h>

#include <string>

namespace predictor {
namespace {

class ConsoleTalk : public testing::Test {
 protected:
  ConsoleTalk() { record_.cause_hand = -1; }

  // The next record, in a state, with what was asked for in its tick; the lines that are told.
  std::string Tick(RunState state, std::initializer_list<RunEvent> asked = {}) {
    ++record_.tick;
    record_.state = state;
    record_.requests = 0;
    for (const RunEvent event : asked)
      record_.requests |= static_cast<std::uint16_t>(1U << static_cast<int>(event));
    std::string text;
    for (const std::string& line : words_.See(record_, [this] { return trouble_; }))
      text += line + "\n";
    return text;
  }
  std::string Refused(RunState state, RunEvent event, Refusal why) {
    record_.refused = static_cast<std::uint8_t>(1 + static_cast<int>(event));
    record_.why_refused = static_cast<std::uint8_t>(why);
    const std::string text = Tick(state, {event});
    record_.refused = record_.why_refused = 0;
    return text;
  }
  void Stop(StopCause cause, int hand = -1) {
    record_.cause = cause;
    record_.cause_hand = static_cast<std::int8_t>(hand);
  }
  // The parts in this order, each behind the one before.
  static void ExpectInOrder(const std::string& text, std::initializer_list<const char*> parts) {
    std::size_t at = 0;
    for (const char* part : parts) {
      const std::size_t found = text.find(part, at);
      EXPECT_NE(found, std::string::npos) << part << "\n" << text;
      if (found != std::string::npos) at = found;
    }
  }

  TickRecord record_{};
  ConsoleWords words_{false, 1000};
  std::string trouble_;
};

TEST_F(ConsoleTalk, OfWhatGoesWellIsShort) {
  EXPECT_EQ(Tick(RunState::kSelfTest),
            "Now SELFTEST. Wait for IDLE, hands off: the sensors are being tared.\n");
  EXPECT_NE(Tick(RunState::kIdle).find("hold a to align"), std::string::npos);
  EXPECT_EQ(Tick(RunState::kAlign, {RunEvent::kAlignRequested}), "Now ALIGN.\n");
  EXPECT_EQ(Tick(RunState::kAlign, {RunEvent::kAlignRequested}), "");
  EXPECT_NE(Tick(RunState::kArmed).find("hold s to start"), std::string::npos);
  EXPECT_EQ(Tick(RunState::kRun, {RunEvent::kStartRequested}), "Now RUN.\n");
  EXPECT_EQ(Tick(RunState::kRun), "");
}

// Asked for in the tick that stopped: "ask again" would be wrong advice.
TEST_F(ConsoleTalk, OfAStopSaysNothingOfWhatWasRefusedWithIt) {
  Tick(RunState::kArmed);
  Stop(StopCause::kDeadline);
  EXPECT_EQ(Refused(RunState::kStopping, RunEvent::kStartRequested, Refusal::kNotEnabled),
            "Now STOPPING.\n");
}

TEST_F(ConsoleTalk, OfAKeyAtTheWrongTimeSaysWhyAndWhatIsPossible) {
  Tick(RunState::kIdle);
  const std::string start = Tick(RunState::kIdle, {RunEvent::kStartRequested});
  ExpectInOrder(start, {"Not done: s (start) has no place in IDLE.", "hold a to align"});
  EXPECT_NE(Tick(RunState::kIdle, {RunEvent::kReset}).find("z (reset) has no place in IDLE"),
            std::string::npos);
  Tick(RunState::kArmed);
  ExpectInOrder(Tick(RunState::kArmed, {RunEvent::kAlignRequested}),
                {"a (align) has no place in ARMED", "hold s to start"});
  EXPECT_EQ(Tick(RunState::kArmed, {RunEvent::kAlignRequested}), "");  // held
  record_.tick += 1100;
  EXPECT_NE(Tick(RunState::kArmed, {RunEvent::kAlignRequested}), "");  // asked anew
}

TEST_F(ConsoleTalk, OfAKeyThatStopsARunSaysSo) {
  Tick(RunState::kRun);
  Stop(StopCause::kOperator);
  ExpectInOrder(Tick(RunState::kStopping, {RunEvent::kReset}),
                {"Stopped: z (reset) has no place in RUN", "power off is asked for", "STOPPING"});
  // What else stops in that tick is not the key's doing.
  Tick(RunState::kRun);
  Stop(StopCause::kForce, 0);
  EXPECT_EQ(Tick(RunState::kStopping, {RunEvent::kReset}), "Now STOPPING.\n");
  Tick(RunState::kRun);
  Stop(StopCause::kOperator);
  EXPECT_EQ(Tick(RunState::kStopping, {RunEvent::kReset, RunEvent::kStopRequested}),
            "Now STOPPING.\n");
}

TEST_F(ConsoleTalk, OfAStopTellsDangerCauseAdviceAndKeysInThisOrder) {
  Tick(RunState::kStopping);
  Stop(StopCause::kSensor, 1);
  trouble_ = "right: its sensor is too hot.";
  record_.hands[1].present = 1;
  record_.hands[1].real.twist = {0, 0.02, 0, 0, 0, 0};
  ExpectInOrder(Tick(RunState::kHeld),
                {"THE RIGHT ARM STILL MOVES",
                 "Now HELD after the stop 'sensor'. Right hand: the force sensor gave a reading",
                 "right: its sensor is too hot.", "Check the sensor and its cable, then reset.",
                 "Keys: z resets", "hold r", "Ctrl-C"});
}

// What repeats its readings is restarted, and then known anew only by a new start.
TEST_F(ConsoleTalk, OfAFrozenSensorOffersNoReset) {
  Stop(StopCause::kStale, 1);
  record_.cause_quantity = Quantity::kCount;
  const std::string told = Tick(RunState::kHeld);
  EXPECT_NE(told.find("then start the program again"), std::string::npos) << told;
  EXPECT_NE(told.find("Keys: hold r"), std::string::npos) << told;
  EXPECT_EQ(told.find("z resets"), std::string::npos) << told;
}

// Neither a reset nor RECOVERY takes up an arm that had a fault.
TEST_F(ConsoleTalk, OfAnArmAtFaultOffersNothingThatDoesNotHelp) {
  Tick(RunState::kStopping);
  Stop(StopCause::kDevice, 1);
  trouble_ = "right: a protective stop.";
  record_.hands[1].present = 1;
  record_.hands[1].arm_fault = 1;
  const std::string text = Tick(RunState::kHeld);
  ExpectInOrder(text, {"Now HELD after the stop 'device'. Right hand: the device reported a fault.",
                       "right: a protective stop.", "then start the program again.",
                       "Keys: Ctrl-C ends.", "the robot's own means"});
  EXPECT_EQ(text.find("hold r"), std::string::npos) << text;
  EXPECT_EQ(text.find("z resets"), std::string::npos) << text;
}

// As where an arm that holds clamps a hand, and then stops itself: neither state nor cause changes.
TEST_F(ConsoleTalk, OfAnArmsFaultBehindAStopSaysSoOnce) {
  for (const RunState state : {RunState::kStopping, RunState::kHeld, RunState::kUnpowered}) {
    words_ = ConsoleWords{false, 1000};
    trouble_ = "";
    record_.hands = {};
    Stop(StopCause::kForce, 0);
    Tick(state);
    record_.hands[1].arm_fault = 1;  // of an arm that is absent
    EXPECT_EQ(Tick(state), "") << Name(state);
    record_.hands[1].present = 1;
    trouble_ = "right: a protective stop.";
    EXPECT_EQ(Tick(state),
              "The right arm reports a fault, too. right: a protective stop. An arm that had a "
              "fault is not moved any more: if a hand is caught, free it by the robot's own means "
              "(free-drive or brake release).\n")
        << Name(state);
    EXPECT_EQ(Tick(state), "") << Name(state);
    trouble_ = "";
    record_.hands[0].present = record_.hands[0].arm_fault = 1;
    const std::string left = Tick(state);
    EXPECT_TRUE(left.starts_with("The left arm reports a fault, too. An arm that had")) << left;
  }
  for (const RunState state : {RunState::kIdle, RunState::kRun, RunState::kRecovery}) {
    words_ = ConsoleWords{false, 1000};
    record_.hands = {};
    Tick(state);
    record_.hands[1].present = record_.hands[1].arm_fault = 1;
    EXPECT_EQ(Tick(state), "") << Name(state);  // it stops the arms, and is told as the cause
  }
}

// Where the state changes with it, it is told there, and once.
TEST_F(ConsoleTalk, OfAnArmsFaultWithAChangeOfStateSaysSoThere) {
  Stop(StopCause::kForce, 0);
  Tick(RunState::kStopping);
  record_.hands[1].present = record_.hands[1].arm_fault = 1;
  const std::string text = Tick(RunState::kHeld);
  EXPECT_EQ(text.find("reports a fault, too"), std::string::npos) << text;
  ExpectInOrder(text, {"Now HELD after the stop 'force'", "clear the fault there, then start the",
                       "Keys: Ctrl-C ends. An arm that had a fault is not moved any more"});
  EXPECT_EQ(Tick(RunState::kHeld), "");
}

TEST_F(ConsoleTalk, WithoutPowerSaysWhatDoes) {
  Tick(RunState::kStopping);
  Stop(StopCause::kDevice, 1);
  const std::string text = Tick(RunState::kUnpowered);
  EXPECT_EQ(text.find("then reset"), std::string::npos) << text;
  EXPECT_EQ(text.find("hold r"), std::string::npos) << text;
  ExpectInOrder(text, {"Now UNPOWERED after the stop 'device'", "switched on at its own panel",
                       "the program started again", "Ctrl-C ends"});
}

TEST_F(ConsoleTalk, OfARefusedResetNamesWhatIsInTheWay) {
  Stop(StopCause::kStale, 0);
  Tick(RunState::kHeld);
  EXPECT_NE(Refused(RunState::kHeld, RunEvent::kReset, Refusal::kCauseRemains)
                .find("It was: Left hand: no fresh sample came in time"),
            std::string::npos);
  record_.tick += 1100;
  record_.read.cause = StopCause::kSensor;
  record_.read.hand = 1;
  EXPECT_NE(Refused(RunState::kHeld, RunEvent::kReset, Refusal::kCauseRemains)
                .find("Now: Right hand: the force sensor"),
            std::string::npos);
  record_.tick += 1100;
  trouble_ = "left: power is off.";
  EXPECT_NE(Refused(RunState::kHeld, RunEvent::kReset, Refusal::kCauseRemains)
                .find("Now: left: power is off."),
            std::string::npos);
  record_.tick += 1100;
  record_.hands[0].present = 1;
  record_.hands[0].wrench = {3, 4, 12, 0, 0, 2};
  EXPECT_NE(Refused(RunState::kHeld, RunEvent::kReset, Refusal::kHandLoaded)
                .find("Now: left handle 13.0 N, 2.00 N·m."),
            std::string::npos);
  // The same key, held on.
  EXPECT_EQ(Refused(RunState::kHeld, RunEvent::kReset, Refusal::kHandLoaded), "");
}

TEST(ConsoleTalkWithADevice, NamesItInsteadOfAHeldKey) {
  ConsoleWords words(true, 1000);
  TickRecord record{};
  record.state = RunState::kIdle;
  const auto lines = words.See(record, [] { return std::string(); });
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("hold the enabling device and touch a to align"), std::string::npos);
}

// What is refused, and how to recover, in words of the rig's own way to enable.
TEST(ConsoleTalkWithADevice, OfARefusalSaysWhatToHold) {
  for (const bool device : {false, true})
    for (const Refusal why : {Refusal::kNotEnabled, Refusal::kBeyondJoint, Refusal::kBeyondLinks,
                              Refusal::kHandLoaded, Refusal::kMoves}) {
      ConsoleWords words(device, 1000);
      TickRecord record{};
      record.state = RunState::kHeld;
      static_cast<void>(words.See(record, [] { return std::string(); }));
      ++record.tick;
      record.refused = 1 + static_cast<int>(RunEvent::kReset);
      record.why_refused = static_cast<std::uint8_t>(why);
      const auto lines = words.See(record, [] { return std::string(); });
      ASSERT_EQ(lines.size(), 1U);
      const std::string& told = lines[0];
      const auto says = [&told](const char* text) { return told.find(text) != std::string::npos; };
      const bool moves = why == Refusal::kMoves, enables = why == Refusal::kNotEnabled;
      EXPECT_EQ(says("The enabling device does not count as held"), enables && device) << told;
      EXPECT_EQ(says("Nobody holds the enabling key"), enables && !device) << told;
      EXPECT_EQ(says("To recover, hold r."), !enables && !moves && !device) << told;
      EXPECT_EQ(says("To recover, hold the enabling device and touch r."),
                !enables && !moves && device)
          << told;
      record.tick += 1100;  // where nothing moves any more, RECOVERY does not either
      record.state = RunState::kUnpowered;
      record.why_refused = static_cast<std::uint8_t>(Refusal::kHandLoaded);
      EXPECT_EQ(words.See(record, [] { return std::string(); })[0].find("To recover"),
                std::string::npos);
    }
}

}  // namespace
}  // namespace predictor
