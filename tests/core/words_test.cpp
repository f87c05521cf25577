// Tests messages about a run, which are selected by their ids in the catalogue.
#include "core/words.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/message_catalogue.h"

namespace predictor {
namespace {

std::string Text(const std::string& id) { return std::string(FindMessage(id)); }

std::string Capitalised(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

TEST(MessageCatalogue, FillsInValues) {
  EXPECT_EQ(FillIn("{a} and {b}, {a}", {{"a", "1"}, {"b", "{a}"}}), "1 and {a}, 1");
  EXPECT_EQ(FillIn("{a} {unknown} {open", {{"a", ""}}), " {unknown} {open");
  EXPECT_EQ(FillIn(""), "");
  EXPECT_EQ(MessageOf("no.such.id"), "no.such.id");
}

TEST(MessageCatalogue, HasEachIdOnceAndNoEmptyText) {
  for (const CatalogueEntry& entry : kMessageCatalogue) {
    EXPECT_FALSE(entry.text.empty()) << entry.id;
    EXPECT_EQ(FindMessage(entry.id).data(), entry.text.data()) << entry.id << " occurs twice";
  }
}

TEST(MessageCatalogue, NamesEachState) {
  for (int s = 0; s < kRunStates; ++s) {
    const std::string name = Name(static_cast<RunState>(s));
    for (const std::string& id :
         {"state." + name + ".title", "state." + name + ".meaning", "console.possible." + name})
      EXPECT_NE(Text(id), "") << id;
  }
}

TEST(StopMessage, NamesCauseAdviceAndNextStepOfEachCause) {
  for (int c = 1; c < kStopCauses; ++c) {
    TickRecord record{};
    record.cause = static_cast<StopCause>(c);
    record.cause_hand = -1;
    const std::string id = std::string("stop.") + Name(record.cause);
    ASSERT_NE(Text(id + ".cause"), "") << id;
    ASSERT_NE(Text(id + ".advice"), "") << id;
    EXPECT_EQ(StopCauseWords(record), Capitalised(Text(id + ".cause")) + ".");
    const bool device = record.cause == StopCause::kDevice;
    EXPECT_EQ(StopAdvice(record),
              Text(id + ".advice") + " " + Text(device ? "next.restart" : "next.reset"));
    record.state = RunState::kUnpowered;
    EXPECT_EQ(StopAdvice(record), Text(id + ".advice") + " " + Text("next.unpowered"));
  }
}

// The measured quantity can be more specific than the cause of the stop.
TEST(StopMessage, DependsOnTheMeasuredQuantity) {
  struct Case {
    StopCause cause;
    Quantity quantity;
    std::string id;
    const char* next;
  };
  for (const Case& c :
       {Case{StopCause::kStale, Quantity::kArmAge, "stop.arm_stale", "next.reset"},
        Case{StopCause::kStale, Quantity::kSensorAge, "stop.sensor_stale", "next.reset"},
        Case{StopCause::kStale, Quantity::kCount, "stop.sensor_frozen", "next.restart"},
        Case{StopCause::kOscillation, Quantity::kVibration, "stop.vibration", "next.reset"},
        Case{StopCause::kSensor, Quantity::kForce, "stop.taring", "next.reset"},
        Case{StopCause::kDevice, Quantity::kAngle, "stop.angle_jump", "next.restart"},
        Case{StopCause::kDeadline, Quantity::kTime, "stop.suspended", "next.reset"},
        Case{StopCause::kDevice, Quantity::kSpeed, "stop.no_rest", "next.restart"}}) {
    TickRecord record{};
    record.cause = c.cause;
    record.cause_hand = 0;
    record.cause_quantity = c.quantity;
    ASSERT_NE(Text(c.id + ".cause"), "") << c.id;
    const std::string cause = Message("hand.left", {{"text", Text(c.id + ".cause")}});
    EXPECT_TRUE(StopCauseWords(record).starts_with(cause + " (")) << StopCauseWords(record);
    EXPECT_EQ(StopAdvice(record), Text(c.id + ".advice") + " " + Text(c.next));
    EXPECT_EQ(CauseAdvice({c.cause, 0, 0, 0, c.quantity}), Text(c.id + ".advice"));
    record.state = RunState::kUnpowered;
    EXPECT_TRUE(StopAdvice(record).ends_with(Text("next.unpowered"))) << StopAdvice(record);
  }
}

TEST(StopMessage, NamesHandAndNumbers) {
  TickRecord record{};
  EXPECT_EQ(StopCauseWords(record) + StopAdvice(record), "");
  record.cause = StopCause::kForce;
  record.cause_hand = 1;
  record.cause_quantity = Quantity::kForce;
  record.cause_value = 31.25;
  record.cause_limit = 30;
  EXPECT_EQ(StopCauseWords(record),
            Message("hand.right", {{"text", Text("stop.force.cause")}}) + " (31.2 N, limit 30 N).");
  EXPECT_EQ(StopAdvice(record), Text("stop.force.advice") + " " + Text("next.reset"));
}

TEST(StopMessage, OfThePhysicsStatesWhatDiverged) {
  const auto words = [](Quantity quantity, double value, double limit) {
    return CauseWords({StopCause::kPhysics, -1, value, limit, quantity});
  };
  const std::string cause = Capitalised(Text("stop.physics.cause"));
  EXPECT_EQ(words(Quantity::kSpeed, 150, 100),
            cause + " (largest speed: 150000 mm/s, limit 100000 mm/s)");
  EXPECT_EQ(words(Quantity::kAcceleration, 2e6, 1e6),
            cause + " (largest acceleration: 2000000 m/s², limit 1000000 m/s²)");
  EXPECT_EQ(words(Quantity::kAngularAcceleration, 2e6, 1e6),
            cause + " (largest acceleration: 2000000 rad/s², limit 1000000 rad/s²)");
  EXPECT_EQ(words(Quantity::kNotFinite, std::nan(""), 0),
            cause + " (" + Text("value.not_finite") + ")");
  EXPECT_EQ(words(Quantity::kNone, 0, 0), cause);
  EXPECT_EQ(words(Quantity::kAllocations, 2, 0),
            Capitalised(Text("stop.controller_allocates.cause")) + " (" +
                Message("value.allocations", {{"count", "2"}}) + ")");
}

TEST(StopMessage, NamesTheFaultThatEscalatedItToPowerOff) {
  TickRecord record{};
  record.state = RunState::kUnpowered;
  record.cause = StopCause::kDeadline;
  record.cause_hand = -1;
  record.cause_quantity = Quantity::kCount;
  record.cause_value = 3;
  record.cause_limit = 2;
  record.harder = ToRecord({StopCause::kStale, 0, 0.0214, 0.02, Quantity::kArmAge});
  const std::string later = Message("hand.left", {{"text", Text("stop.arm_stale.cause")}});
  EXPECT_EQ(StopCauseWords(record),
            Capitalised(Text("stop.deadline.cause")) + " (3, limit 2). " +
                Message("stop.power_off_because", {{"cause", later + " (21.4 ms, limit 20 ms)."}}));
  EXPECT_EQ(StopAdvice(record), Text("stop.deadline.advice") + " " + Text("stop.arm_stale.advice") +
                                    " " + Text("next.unpowered"));
  EXPECT_FALSE(NeedsANewStart(record));
  record.harder = ToRecord({StopCause::kDevice, 1, 0.03, 0.01, Quantity::kSpeed});
  EXPECT_TRUE(NeedsANewStart(record));
  record.cause = StopCause::kStale;  // the same advice appears once
  record.cause_quantity = Quantity::kArmAge;
  record.harder = ToRecord({StopCause::kStale, 0, 0.0214, 0.02, Quantity::kArmAge});
  record.state = RunState::kHeld;
  EXPECT_EQ(StopAdvice(record), Text("stop.arm_stale.advice") + " " + Text("next.reset"));
}

// An arm may stop itself after the first cause, for example because it clamps a hand.
TEST(StopMessage, AdvisesOnAnArmFaultAfterTheCause) {
  TickRecord record{};
  record.state = RunState::kHeld;
  record.cause = StopCause::kForce;
  record.hands[1].arm_fault = 1;  // an absent arm
  EXPECT_FALSE(NeedsANewStart(record));
  EXPECT_EQ(StopAdvice(record), Text("stop.force.advice") + " " + Text("next.reset"));
  record.hands[1].present = 1;
  EXPECT_TRUE(NeedsANewStart(record));
  EXPECT_EQ(StopAdvice(record), Text("stop.force.advice") + " " + Text("stop.device.advice") + " " +
                                    Text("next.restart"));
  record.cause = StopCause::kDevice;  // the same advice appears once
  EXPECT_EQ(StopAdvice(record), Text("stop.device.advice") + " " + Text("next.restart"));
}

TEST(WarningMessage, AppearsOncePerWarning) {
  HandRecord hand{};
  EXPECT_TRUE(NewWarnings(0, hand, 0).empty());
  hand.warnings = 0b1010;
  hand.warning_values = {0, 0.034, 0, 3.5};
  const auto words = NewWarnings(0, hand, 0);
  ASSERT_EQ(words.size(), 2U);
  EXPECT_EQ(words[0], Message("warning.sensor_loss", {{"percent", "3.4"}, {"side", "left"}}));
  EXPECT_EQ(words[1], Message("warning.bias_drift", {{"drift", "3.5"}, {"side", "left"}}));
  EXPECT_EQ(NewWarnings(0b0010, hand, 0).size(), 1U);
  EXPECT_TRUE(NewWarnings(hand.warnings, hand, 0).empty());
}

TEST(WarningMessage, NamesTheArmThatStillHasPower) {
  HandRecord hand{};
  hand.warnings = 1U << static_cast<unsigned>(Warning::kKeepsPower) |
                  1U << static_cast<unsigned>(Warning::kNoPowerOff);
  const auto words = NewWarnings(0, hand, 1);
  ASSERT_EQ(words.size(), 2U);
  EXPECT_EQ(words[0], Message("warning.no_power_off", {{"side", "right"}}));
  EXPECT_EQ(words[1], Message("danger.keeps_power", {{"SIDE", "RIGHT"}}));
  EXPECT_EQ(NewWarnings(0b1111, hand, 0)[1], Message("danger.keeps_power", {{"SIDE", "LEFT"}}));
}

// No text that the program prints may contain an unreplaced placeholder.
TEST(WarningMessage, FillsInAllValues) {
  for (int w = 0; w < kWarnings; ++w) {
    const std::string text = WarningWords(static_cast<Warning>(w), 0, 0.5);
    EXPECT_NE(text, "") << w;
    EXPECT_EQ(text.find('{'), std::string::npos) << text;
  }
}

// Repeated requests produce one message. After a pause or for another reason, a new message
// appears.
TEST(RefusalMessage, AppearsOncePerRequest) {
  RefusalWords words(1000);
  TickRecord record{};
  record.state = RunState::kHeld;
  EXPECT_EQ(words.See(record), "");
  record.refused = 9;
  const auto at = [&](std::uint64_t tick, Refusal why) {
    record.tick = tick;
    record.why_refused = static_cast<std::uint8_t>(why);
    return words.See(record);
  };
  EXPECT_EQ(at(1000, Refusal::kHandLoaded),
            Message("refusal.done", {{"why", Text("refusal.hand_loaded")}}));
  for (std::uint64_t tick = 1001; tick < 5000; tick += 100)
    EXPECT_EQ(at(tick, Refusal::kHandLoaded), "");
  record.cause = StopCause::kForce;
  record.cause_quantity = Quantity::kForce;
  const std::string remains = at(5000, Refusal::kCauseRemains);
  EXPECT_TRUE(remains.ends_with(Message("refusal.was", {{"cause", StopCauseWords(record)}})))
      << remains;
  EXPECT_EQ(at(5599, Refusal::kCauseRemains), "");
  EXPECT_NE(at(6199, Refusal::kCauseRemains), "");
  record.state = RunState::kStopping;  // has a separate message
  EXPECT_EQ(at(9000, Refusal::kCauseRemains), "");
}

}  // namespace
}  // namespace predictor
