// Tests the messages that the console prints for the records of a run.
#include "safety/console_words.h"

#include <gtest/gtest.h>

#include <string>

#include "core/message_catalogue.h"
#include "core/words.h"

namespace predictor {
namespace {

std::string Text(const char* id) { return std::string(FindMessage(id)); }

class ConsoleTalk : public testing::Test {
 protected:
  ConsoleTalk() { record_.cause_hand = -1; }

  // Processes the next record, which contains a state and the requests of the record's tick.
  // Returns the printed lines.
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
  // Expects that the text contains the parts in this order.
  static void ExpectInOrder(const std::string& text, std::initializer_list<std::string> parts) {
    std::size_t at = 0;
    for (const std::string& part : parts) {
      const std::size_t found = text.find(part, at);
      EXPECT_NE(found, std::string::npos) << part << "\n" << text;
      if (found != std::string::npos) at = found;
    }
  }

  static std::string Now(const char* state) { return Message("console.state", {{"state", state}}); }
  static std::string KeyRefused(char key, const char* name, const char* state) {
    return Message(
        "console.key_refused",
        {{"key", std::string(1, key)}, {"name", name}, {"state", state}, {"possible", ""}});
  }
  // Returns the line that reports the record's stop.
  std::string Stopped(const char* state) const {
    return Message(
        "console.stopped",
        {{"state", state}, {"name", Name(record_.cause)}, {"cause", StopCauseWords(record_)}});
  }

  TickRecord record_{};
  ConsoleWords words_{false, 1000};
  std::string trouble_;
};

TEST_F(ConsoleTalk, IsShortIfThereAreNoProblems) {
  EXPECT_EQ(Tick(RunState::kSelfTest),
            Now("SELFTEST") + " " + Text("console.possible.SELFTEST") + "\n");
  EXPECT_NE(Tick(RunState::kIdle).find("hold a to align"), std::string::npos);
  EXPECT_EQ(Tick(RunState::kAlign, {RunEvent::kAlignRequested}), Now("ALIGN") + "\n");
  EXPECT_EQ(Tick(RunState::kAlign, {RunEvent::kAlignRequested}), "");
  EXPECT_NE(Tick(RunState::kArmed).find("hold s to start"), std::string::npos);
  EXPECT_EQ(Tick(RunState::kRun, {RunEvent::kStartRequested}), Now("RUN") + "\n");
  EXPECT_EQ(Tick(RunState::kRun), "");
}

// The request belongs to the tick of the stop, so the advice "ask again" would be wrong.
TEST_F(ConsoleTalk, OmitsRefusedRequestsInTheTickOfAStop) {
  Tick(RunState::kArmed);
  Stop(StopCause::kDeadline);
  EXPECT_EQ(Refused(RunState::kStopping, RunEvent::kStartRequested, Refusal::kNotEnabled),
            Now("STOPPING") + "\n");
}

TEST_F(ConsoleTalk, ExplainsAKeyAtTheWrongTime) {
  Tick(RunState::kIdle);
  const std::string start = Tick(RunState::kIdle, {RunEvent::kStartRequested});
  ExpectInOrder(start, {KeyRefused('s', "start", "IDLE"), "hold a to align"});
  ExpectInOrder(Tick(RunState::kIdle, {RunEvent::kReset}), {KeyRefused('z', "reset", "IDLE")});
  Tick(RunState::kArmed);
  ExpectInOrder(Tick(RunState::kArmed, {RunEvent::kAlignRequested}),
                {KeyRefused('a', "align", "ARMED"), "hold s to start"});
  EXPECT_EQ(Tick(RunState::kArmed, {RunEvent::kAlignRequested}), "");  // key still held
  record_.tick += 1100;
  EXPECT_NE(Tick(RunState::kArmed, {RunEvent::kAlignRequested}), "");  // asked again
}

TEST_F(ConsoleTalk, ReportsAKeyThatStopsARun) {
  Tick(RunState::kRun);
  Stop(StopCause::kOperator);
  ExpectInOrder(Tick(RunState::kStopping, {RunEvent::kReset}),
                {Message("console.key_stops", {{"key", "z"}, {"name", "reset"}, {"state", "RUN"}}),
                 Now("STOPPING")});
  // If the arms stop for another reason in the same tick, the message must not give the key as the
  // cause.
  Tick(RunState::kRun);
  Stop(StopCause::kForce, 0);
  EXPECT_EQ(Tick(RunState::kStopping, {RunEvent::kReset}), Now("STOPPING") + "\n");
  Tick(RunState::kRun);
  Stop(StopCause::kOperator);
  EXPECT_EQ(Tick(RunState::kStopping, {RunEvent::kReset, RunEvent::kStopRequested}),
            Now("STOPPING") + "\n");
}

TEST_F(ConsoleTalk, OfAStopShowsDangerCauseAdviceAndKeysInThisOrder) {
  Tick(RunState::kStopping);
  Stop(StopCause::kSensor, 1);
  trouble_ = "right: its sensor is too hot.";
  record_.hands[1].present = 1;
  record_.hands[1].real.twist = {0, 0.02, 0, 0, 0, 0};
  ExpectInOrder(Tick(RunState::kHeld), {Message("danger.still_moves", {{"SIDE", "RIGHT"}}),
                                        Stopped("HELD"), "right: its sensor is too hot.",
                                        Text("stop.sensor.advice") + " " + Text("next.reset"),
                                        "z resets", "hold r", "Ctrl-C"});
}

// A sensor that repeats its readings must be restarted. After that, the program must be started
// again before it accepts the sensor.
TEST_F(ConsoleTalk, OffersNoResetForAFrozenSensor) {
  Stop(StopCause::kStale, 1);
  record_.cause_quantity = Quantity::kCount;
  const std::string reported = Tick(RunState::kHeld);
  EXPECT_NE(reported.find(Text("next.restart")), std::string::npos) << reported;
  EXPECT_NE(reported.find("hold r"), std::string::npos) << reported;
  EXPECT_EQ(reported.find("z resets"), std::string::npos) << reported;
}

// Neither a reset nor RECOVERY can make an arm usable again after a fault.
TEST_F(ConsoleTalk, OffersOnlyUsefulActionsForAFaultyArm) {
  Tick(RunState::kStopping);
  Stop(StopCause::kDevice, 1);
  trouble_ = "right: a protective stop.";
  record_.hands[1].present = 1;
  record_.hands[1].arm_fault = 1;
  const std::string text = Tick(RunState::kHeld);
  ExpectInOrder(text, {Stopped("HELD"), "right: a protective stop.", Text("next.restart"),
                       Text("console.possible.HELD_fault"), Text("console.arm_fault_free")});
  EXPECT_EQ(text.find("hold r"), std::string::npos) << text;
  EXPECT_EQ(text.find("z resets"), std::string::npos) << text;
}

// For example, an arm that holds its position may trap a hand and then stop itself. Neither the
// state nor the cause of the stop changes.
TEST_F(ConsoleTalk, ReportsAnArmsFaultAfterAStopOnce) {
  for (const RunState state : {RunState::kStopping, RunState::kHeld, RunState::kUnpowered}) {
    words_ = ConsoleWords{false, 1000};
    trouble_ = "";
    record_.hands = {};
    Stop(StopCause::kForce, 0);
    Tick(state);
    record_.hands[1].arm_fault = 1;  // the arm is absent
    EXPECT_EQ(Tick(state), "") << Name(state);
    record_.hands[1].present = 1;
    trouble_ = "right: a protective stop.";
    EXPECT_EQ(Tick(state), Message("console.arm_fault", {{"side", "right"}}) +
                               " right: a protective stop. " + Text("console.arm_fault_free") +
                               "\n")
        << Name(state);
    EXPECT_EQ(Tick(state), "") << Name(state);
    trouble_ = "";
    record_.hands[0].present = record_.hands[0].arm_fault = 1;
    const std::string left = Tick(state);
    EXPECT_EQ(left, Message("console.arm_fault", {{"side", "left"}}) + " " +
                        Text("console.arm_fault_free") + "\n");
  }
  for (const RunState state : {RunState::kIdle, RunState::kRun, RunState::kRecovery}) {
    words_ = ConsoleWords{false, 1000};
    record_.hands = {};
    Tick(state);
    record_.hands[1].present = record_.hands[1].arm_fault = 1;
    // the fault stops the arms and is reported as the cause
    EXPECT_EQ(Tick(state), "") << Name(state);
  }
}

// If the state changes in the same tick, the fault must be reported once, together with the state.
TEST_F(ConsoleTalk, ReportsAnArmsFaultWithTheChangeOfState) {
  Stop(StopCause::kForce, 0);
  Tick(RunState::kStopping);
  record_.hands[1].present = record_.hands[1].arm_fault = 1;
  const std::string text = Tick(RunState::kHeld);
  EXPECT_EQ(text.find(Message("console.arm_fault", {{"side", "right"}})), std::string::npos)
      << text;
  ExpectInOrder(text, {Stopped("HELD"), Text("stop.device.advice") + " " + Text("next.restart"),
                       Text("console.possible.HELD_fault") + " " + Text("console.arm_fault_free")});
  EXPECT_EQ(Tick(RunState::kHeld), "");
}

TEST_F(ConsoleTalk, StatesTheRemedyWithoutPower) {
  Tick(RunState::kStopping);
  Stop(StopCause::kDevice, 1);
  const std::string text = Tick(RunState::kUnpowered);
  EXPECT_EQ(text.find(Text("next.reset")), std::string::npos) << text;
  EXPECT_EQ(text.find("hold r"), std::string::npos) << text;
  ExpectInOrder(text, {Stopped("UNPOWERED"), Text("next.unpowered"), "Ctrl-C ends"});
}

TEST_F(ConsoleTalk, NamesTheReasonForARefusedReset) {
  Stop(StopCause::kStale, 0);
  Tick(RunState::kHeld);
  ExpectInOrder(Refused(RunState::kHeld, RunEvent::kReset, Refusal::kCauseRemains),
                {Message("refusal.was", {{"cause", StopCauseWords(record_)}})});
  record_.tick += 1100;
  record_.read.cause = StopCause::kSensor;
  record_.read.hand = 1;
  const std::string sensor = Message("hand.right", {{"text", Text("stop.sensor.cause")}});
  ExpectInOrder(Refused(RunState::kHeld, RunEvent::kReset, Refusal::kCauseRemains),
                {Message("refusal.now", {{"what", sensor}})});
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
  // The person still holds the same key.
  EXPECT_EQ(Refused(RunState::kHeld, RunEvent::kReset, Refusal::kHandLoaded), "");
}

TEST(ConsoleTalkWithADevice, NamesItInsteadOfAHeldKey) {
  ConsoleWords words(true, 1000);
  TickRecord record{};
  record.state = RunState::kIdle;
  const auto lines = words.See(record, [] { return std::string(); });
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find(HowToHold('a', true) + " to align"), std::string::npos);
}

// The message must name the refusal and explain how to recover with the enabling method of this
// rig.
TEST(ConsoleTalkWithADevice, StatesWhatToHoldAfterARefusal) {
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
      const std::string& reported = lines[0];
      const auto says = [&reported](const std::string& text) {
        return reported.find(text) != std::string::npos;
      };
      const bool moves = why == Refusal::kMoves, enables = why == Refusal::kNotEnabled;
      EXPECT_EQ(says(Text("refusal.device_not_held")), enables && device) << reported;
      EXPECT_EQ(says(Text("refusal.not_enabled")), enables && !device) << reported;
      EXPECT_EQ(says("To recover, hold r."), !enables && !moves && !device) << reported;
      EXPECT_EQ(says("To recover, hold the enabling device and tap r."),
                !enables && !moves && device)
          << reported;
      record.tick += 1100;  // in a state without motion, RECOVERY does not move either
      record.state = RunState::kUnpowered;
      record.why_refused = static_cast<std::uint8_t>(Refusal::kHandLoaded);
      EXPECT_EQ(words.See(record, [] { return std::string(); })[0].find("To recover"),
                std::string::npos);
    }
}

}  // namespace
}  // namespace predictor
