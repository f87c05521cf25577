// Tests what the hub reports about headsets to the run and to the other pages.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/types.h"
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

// A page sends more heads than are forwarded, but the end of the session must always arrive.
TEST_F(HubTest, ForwardsTheEndOfASessionAfterManyHeads) {
  auto wearer = Admit();
  auto other = Admit();
  for (int k = 0; k < 40; ++k)
    wearer->Say({{"type", "immersive"}, {"active", true}, {"p", {1, 2, 1.7}}, {"q", {1, 0, 0, 0}}});
  wearer->Say({{"type", "immersive"}, {"active", false}});
  EXPECT_EQ(Json::parse(other->connection.newest_text)["active"], false);
}

class MeasuredHeadTest : public HubTest {
 protected:
  Json Head() const {
    return {{"type", "immersive"},
            {"active", true},
            {"p", {1, 2, 1.7}},
            {"q", {1, 0, 0, 0}},
            {"posed", now_ - kSecond / 100},
            {"registration", {{"yaw", 0.5}, {"t", {1, 2, 3}}, {"residual", 0.01}}}};
  }
  std::uint64_t measured() const { return mailbox_.heads.written(); }
};

TEST_F(MeasuredHeadTest, ReachesTheRunWithItsTimeAndRegistration) {
  auto wearer = Admit();
  Json head = Head();
  // The view is along x of W, and upright. Therefore its x axis is -y, its y axis is z, and its z
  // axis is -x.
  const Matrix3 R_WV = (Matrix3() << 0, 0, -1, -1, 0, 0, 0, 1, 0).finished();
  const Quaternion q(R_WV);
  head["q"] = {q.w(), q.x(), q.y(), q.z()};
  wearer->Say(head);
  HeadRecord record;
  ASSERT_TRUE(mailbox_.heads.Get(0, &record));
  EXPECT_EQ(record.wall_ns, now_ - kSecond / 100);
  EXPECT_NEAR(record.delay, 0.01, 1e-12);
  EXPECT_EQ(record.client, wearer->id());
  EXPECT_EQ(record.p, (std::array<double, 3>{1, 2, 1.7}));
  EXPECT_NEAR(std::abs(record.q[0]), 1, 1e-12);  // x forward and z up: the axes of W
  EXPECT_EQ(record.registration.yaw, 0.5);
  EXPECT_EQ(record.registration.t, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(record.registration.residual, 0.01);
}

TEST_F(MeasuredHeadTest, NeedsARegistrationATimeAndAPose) {
  auto wearer = Admit();
  for (const char* missing : {"registration", "posed", "p"}) {
    Json head = Head();
    head.erase(missing);
    if (std::string(missing) == "p") head.erase("q");
    wearer->Say(head);
    EXPECT_EQ(measured(), 0u) << missing;
  }
  wearer->Say(Head());
  EXPECT_EQ(measured(), 1u);
}

TEST_F(MeasuredHeadTest, MustBeFresh) {
  auto wearer = Admit();
  Json head = Head();
  head["posed"] = now_ - kSecond / 2;
  wearer->Say(head);
  head["posed"] = now_ + kSecond / 10;
  wearer->Say(head);
  EXPECT_EQ(measured(), 0u);
  head["posed"] = now_ + kSecond / 100;  // the page only estimates the server's clock
  wearer->Say(head);
  HeadRecord record;
  ASSERT_TRUE(mailbox_.heads.Get(0, &record));
  EXPECT_EQ(record.wall_ns, now_);
  EXPECT_EQ(record.delay, 0);
}

// With several headsets, it is not known which head belongs to the hands on the handles.
TEST_F(MeasuredHeadTest, ComesFromTheOnlyWearer) {
  auto looker = Admit(Role::kLook);
  looker->Say(Head());
  EXPECT_EQ(measured(), 0u);
  looker->Say({{"type", "immersive"}, {"active", false}});
  auto one = Admit();
  one->Say(Head());
  EXPECT_EQ(measured(), 1u);
  auto two = Admit();
  two->Say(Head());
  one->Say(Head());
  EXPECT_EQ(measured(), 1u);
  two->Say({{"type", "immersive"}, {"active", false}});
  one->Say(Head());
  EXPECT_EQ(measured(), 2u);
  Json over = Head();
  over["active"] = false;
  one->Say(over);
  EXPECT_EQ(measured(), 2u);
}

TEST_F(MeasuredHeadTest, IsLimitedToSixtyPerSecond) {
  auto wearer = Admit();
  for (int k = 0; k < 1000; ++k) {
    now_ += kSecond / 150;
    wearer->Say(Head());
  }
  // 60 a second for 6.7 s, and a quarter of a second at the beginning.
  EXPECT_LE(measured(), 60 * 1000 / 150 + 15u);
  EXPECT_GE(measured(), 60 * 1000 / 150 - 1u);
}

}  // namespace
}  // namespace predictor::viewer
