#include "scenario/event_words.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

TEST(TriggerWords, StateWhenAnEventBegins) {
  TriggerSpec trigger;
  EXPECT_EQ(TriggerWords(trigger), "at 0 s");
  trigger.after = 2;
  EXPECT_EQ(TriggerWords(trigger), "at 2 s");
  trigger.window = 1.5;
  EXPECT_EQ(TriggerWords(trigger), "at a random time between 2 and 3.5 s");
}

TEST(TriggerWords, StateAllConditions) {
  TriggerSpec trigger;
  trigger.gripping = true;
  EXPECT_EQ(TriggerWords(trigger), "when every hand grips");
  trigger.force = 10;
  EXPECT_EQ(TriggerWords(trigger), "when a hand's force exceeds 10 N and every hand grips");
  trigger.place = EventPlaceSpec{{0.1, 0, -0.2}, 0.05};
  trigger.after = 2;
  EXPECT_EQ(TriggerWords(trigger),
            "at 2 s or later, when the object is within 0.05 m of (0.1, 0, -0.2) m from its start "
            "and a hand's force exceeds 10 N and every hand grips");
  trigger.window = 1;
  trigger.place.reset();
  trigger.gripping = false;
  EXPECT_EQ(TriggerWords(trigger),
            "at a random time between 2 and 3 s or later, when a hand's force exceeds 10 N");
}

}  // namespace
}  // namespace predictor
