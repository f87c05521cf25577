// Tests what the hub reports about headsets to the run and to the other pages.
#include <gtest/gtest.h>

#include <string>

#include "viewer/hub_fixture.h"

namespace predictor::viewer {
namespace {

TEST_F(HubTest, ReportsHeadsetsAndTheirSilenceToTheRun) {
  auto one = Admit();
  auto two = Admit();
  const auto sees_now = [this] {
    return Json{{"type", "immersive"}, {"active", true}, {"drawn", now_}};
  };
  one->Say(sees_now());
  const std::uint64_t first = now_;
  now_ += kSecond / 10;
  two->Say(sees_now());
  EXPECT_EQ(mailbox_.immersive.load(), 2u);
  // The hub must report the frame of the page that has been silent longest.
  EXPECT_EQ(mailbox_.immersive_frame_ns.load(), first);
  one->Say(sees_now());
  EXPECT_EQ(mailbox_.immersive_frame_ns.load(), first + kSecond / 10);
  one->Say({{"type", "immersive"}, {"active", false}});
  EXPECT_EQ(mailbox_.immersive.load(), 1u);
  two.reset();  // a lost page counts as a silent one
  now_ += kSecond / 2;
  hub_->Tick();
  EXPECT_EQ(mailbox_.immersive.load(), 1u);
  EXPECT_EQ(mailbox_.immersive_frame_ns.load(), first + kSecond / 10);
  now_ += kSecond;
  hub_->Tick();
  EXPECT_EQ(mailbox_.immersive.load(), 0u);
}

// A page may continue to send messages although its picture is frozen.
TEST_F(HubTest, AHeadsetIsAsOldAsThePictureThatItShows) {
  auto page = Admit();
  page->Say({{"type", "immersive"}, {"active", true}});  // nothing drawn so far
  const std::uint64_t entered = now_;
  now_ += kSecond / 10;
  page->Say({{"type", "immersive"}, {"active", true}});
  EXPECT_EQ(mailbox_.immersive_frame_ns.load(), entered);
  const std::uint64_t drawn = now_ - kSecond / 50;
  page->Say({{"type", "immersive"}, {"active", true}, {"drawn", drawn}});
  EXPECT_EQ(mailbox_.immersive_frame_ns.load(), drawn);
  now_ += kSecond;
  page->Say({{"type", "immersive"}, {"active", true}, {"drawn", std::to_string(drawn)}});
  hub_->Tick();
  EXPECT_EQ(mailbox_.immersive_frame_ns.load(), drawn);
  page->Say({{"type", "immersive"}, {"active", true}, {"drawn", now_ + kSecond}});
  // The time of a picture must not be later than the current time.
  EXPECT_EQ(mailbox_.immersive_frame_ns.load(), now_);
}

// When the session ends, the wearer no longer sees the scene, as after a lost connection. If
// nothing moves, the run may ignore the end of the session.
TEST_F(HubTest, WithRealArmsTheEndOfASessionIsSilence) {
  HubSetup setup = TestSetup();
  setup.rules = RulesOfRealArms();
  Make(setup);
  auto page = Admit();
  const std::uint64_t last = now_;
  page->Say({{"type", "immersive"}, {"active", true}, {"drawn", last}});
  page->Say({{"type", "immersive"}, {"active", false}});
  for (int k = 0; k < 9; ++k) {
    now_ += kSecond / 10;
    hub_->Tick();
    EXPECT_EQ(mailbox_.immersive.load(), 1u);
    EXPECT_EQ(mailbox_.immersive_frame_ns.load(), last);
  }
  now_ += kSecond;
  hub_->Tick();
  EXPECT_EQ(mailbox_.immersive.load(), 0u);

  page->Say({{"type", "immersive"}, {"active", true}, {"drawn", now_}});
  page->Say({{"type", "immersive"}, {"active", false}});
  page->Say({{"type", "immersive"}, {"active", true}, {"drawn", now_}});  // resumed immediately
  now_ += 10 * kSecond;
  hub_->Tick();
  EXPECT_EQ(mailbox_.immersive.load(), 1u);
}

TEST_F(HubTest, ShowsAHeadToTheOtherPages) {
  auto wearer = Admit();
  auto other = Admit(Role::kLook);
  const Json head = {
      {"type", "immersive"}, {"active", true}, {"p", {1, 2, 1.7}}, {"q", {1, 0, 0, 0}}};
  wearer->Say(head);
  EXPECT_TRUE(wearer->connection.newest_text.empty());
  const Json shown = Json::parse(other->connection.newest_text);
  EXPECT_EQ(shown["type"], "headset");
  EXPECT_EQ(shown["client"], wearer->id());
  EXPECT_EQ(shown["p"][2], 1.7);
  wearer->Say({{"type", "immersive"}, {"active", false}});
  EXPECT_EQ(Json::parse(other->connection.newest_text)["active"], false);
  EXPECT_EQ(wearer->connection.Last("welcome")["features"][0], "headset");
}

}  // namespace
}  // namespace predictor::viewer
