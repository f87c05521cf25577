#include "viewer/hub.h"

#include <gtest/gtest.h>

#include <deque>

#include "core/choice.h"

namespace predictor::viewer {
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

OperatingRules RulesOfRealArms() {
  Scenario scenario;
  scenario.device.type = "real";
  return RulesFor(scenario);
}

struct FakeConnection : Connection {
  void SendText(std::string text) override { texts.push_back(Json::parse(text)); }
  void SendNewest(std::uint32_t, MessageKind kind,
                  std::shared_ptr<const std::string> message) override {
    (kind == MessageKind::kText ? newest_text : newest) = *message;
  }
  void Close(CloseCode code, std::string) override { closed = code; }
  void Admitted() override { admitted = true; }
  std::string peer() const override { return address; }

  // The last message of this type; null if there was none.
  Json Last(const std::string& type) const {
    Json last;
    for (const Json& text : texts)
      if (text["type"] == type) last = text;
    return last;
  }
  std::size_t CountOf(const std::string& type) const {
    std::size_t n = 0;
    for (const Json& text : texts) n += text["type"] == type;
    return n;
  }

  std::deque<Json> texts;
  std::string newest, newest_text;
  std::optional<CloseCode> closed;
  bool admitted = false;
  std::string address = "192.0.2.7";
};

class HubTest : public testing::Test {
 protected:
  struct Page {
    FakeConnection connection;
    std::unique_ptr<Session> session;
    void Say(const Json& message) { session->OnText(message.dump()); }
    std::uint32_t id() const { return connection.Last("welcome")["client"].get<std::uint32_t>(); }
  };

  static HubSetup TestSetup() {
    HubSetup setup;
    setup.scene = {{"name", "test"}};
    setup.browser_operator = true;
    setup.present = {true, false};
    for (ParameterRange& range : setup.ranges) range = {0.5, 2, 1};
    return setup;
  }

  void Make(const HubSetup& setup) {
    hub_ = std::make_unique<Hub>(setup, &admission_, &mailbox_, [this] { return now_; });
  }
  HubTest() { Make(TestSetup()); }

  std::unique_ptr<Page> Connect() {
    auto page = std::make_unique<Page>();
    page->session = hub_->Open(&page->connection);
    return page;
  }
  std::unique_ptr<Page> Admit(Role role = Role::kControl) {
    auto page = Connect();
    page->Say({{"type", "hello"}, {"token", admission_.IssueToken(role)}});
    EXPECT_TRUE(page->connection.admitted);
    return page;
  }
  std::unique_ptr<Page> Controller() {
    auto page = Admit();
    page->Say({{"type", "lease"}, {"what", "control"}, {"take", true}});
    return page;
  }
  std::vector<RunInput> Inputs() {
    std::vector<RunInput> inputs;
    for (RunInput input; mailbox_.inputs.Pop(&input);) inputs.push_back(input);
    return inputs;
  }
  static Json Hand(const char* side) {
    return {{"type", "hand"},
            {"hand", side},
            {"grip", true},
            {"p", {0.1, 0.2, 0.3}},
            {"q", {1, 0, 0, 0}}};
  }

  std::uint64_t now_ = 1000 * kSecond;
  Admission admission_{false, NewAdmissionSecret()};
  RunMailbox mailbox_;
  std::unique_ptr<Hub> hub_;
};

TEST_F(HubTest, WelcomesWhoHasTheCode) {
  auto page = Connect();
  page->Say({{"type", "hello"}, {"code", admission_.code()}});
  const Json welcome = page->connection.Last("welcome");
  EXPECT_EQ(welcome["role"], "control");
  EXPECT_EQ(welcome["scene"]["name"], "test");
  EXPECT_EQ(welcome["server_ns"], now_);
  EXPECT_EQ(welcome["frame"].size(), FrameJson().size());
  EXPECT_EQ(welcome["leases"]["clients"], 1);
  EXPECT_EQ(mailbox_.clients.load(), 1u);
  auto again = Connect();
  again->Say({{"type", "hello"}, {"token", welcome["token"]}});
  EXPECT_EQ(again->connection.Last("welcome")["token"], welcome["token"]);
  EXPECT_EQ(again->connection.Last("welcome")["server"], welcome["server"]);
}

TEST_F(HubTest, RefusesEverybodyElse) {
  for (const Json& hello :
       {Json{{"type", "hello"}, {"code", "wrong"}}, Json{{"type", "hello"}, {"pin", "123456"}},
        Json{{"type", "hello"}, {"token", "wrong"}}}) {
    auto page = Connect();
    page->Say(hello);
    EXPECT_FALSE(page->connection.admitted);
    EXPECT_EQ(page->connection.CountOf("refused"), 1u);
    EXPECT_EQ(page->connection.CountOf("welcome"), 0u);
    EXPECT_EQ(page->connection.closed, CloseCode::kRefused);
  }
}

TEST_F(HubTest, NothingIsTakenBeforeHello) {
  auto page = Connect();
  page->Say({{"type", "stop"}});
  EXPECT_EQ(page->connection.closed, CloseCode::kRefused);
  EXPECT_EQ(mailbox_.stops.load(), 0u);
  page->Say({{"type", "hello"}, {"code", admission_.code()}});  // too late
  EXPECT_FALSE(page->connection.admitted);
  hub_->Publish(std::make_shared<const std::string>("state"), RunState::kRun);
  EXPECT_EQ(page->connection.newest, "");
}

TEST_F(HubTest, WhoSaysNothingForFiveSecondsIsCutOff) {
  auto silent = Connect();
  auto admitted = Admit();
  now_ += 5 * kSecond;
  hub_->Tick();
  EXPECT_FALSE(silent->connection.closed);
  now_ += 1;
  hub_->Tick();
  EXPECT_EQ(silent->connection.closed, CloseCode::kRefused);
  EXPECT_FALSE(admitted->connection.closed);
}

TEST_F(HubTest, WhatIsNotUnderstoodEndsTheConnection) {
  auto page = Admit();
  page->session->OnText("{\"type\": \"format disk\"}");
  EXPECT_EQ(page->connection.closed, CloseCode::kNotUnderstood);
  auto binary = Admit();
  binary->session->OnBinary();
  EXPECT_EQ(binary->connection.closed, CloseCode::kNotUnderstood);
  auto twice = Admit();
  twice->Say({{"type", "hello"}, {"code", admission_.code()}});
  EXPECT_EQ(twice->connection.closed, CloseCode::kNotUnderstood);
}

TEST_F(HubTest, SixtyFourClientsAndNoMore) {
  std::vector<std::unique_ptr<Page>> pages;
  for (std::size_t i = 0; i < Hub::kMostClients; ++i) pages.push_back(Admit());
  auto late = Connect();
  late->Say({{"type", "hello"}, {"code", admission_.code()}});
  EXPECT_EQ(late->connection.closed, CloseCode::kTryLater);
  EXPECT_FALSE(late->connection.admitted);
  EXPECT_EQ(late->connection.CountOf("refused"), 0u);  // its code or token is valid
  pages.pop_back();
  EXPECT_EQ(hub_->clients(), 63u);
  Admit();
}

// ---- stopping -----------------------------------------------------------------------------------

TEST_F(HubTest, WhoeverLooksMayStop) {
  auto page = Admit(Role::kLook);
  page->Say({{"type", "stop"}});
  EXPECT_EQ(mailbox_.stops.load(), 1u);
}

// A stop has priority over the message limit, over a full mailbox, and even over a disconnection
// for flooding.
TEST_F(HubTest, NoLimitHoldsBackAStop) {
  auto page = Admit();
  while (mailbox_.inputs.Push({})) {
  }
  for (int i = 0; i < 400; ++i) page->Say({{"type", "heartbeat"}});
  EXPECT_FALSE(page->connection.closed);
  page->Say({{"type", "ping"}, {"page_ms", 1}});
  EXPECT_EQ(page->connection.CountOf("pong"), 0u);  // beyond the limit: ignored
  page->Say({{"type", "stop"}});
  EXPECT_EQ(mailbox_.stops.load(), 1u);
  std::uint32_t stops = 1;
  while (!page->connection.closed) {
    page->Say({{"type", "stop"}});
    ASSERT_EQ(mailbox_.stops.load(), ++stops);
    ASSERT_LT(stops, 3000u);
  }
  EXPECT_EQ(page->connection.closed, CloseCode::kRefused);
}

// ---- commanding ---------------------------------------------------------------------------------

TEST_F(HubTest, OneCommandsAtATime) {
  auto first = Controller();
  auto second = Admit();
  second->Say({{"type", "lease"}, {"what", "control"}, {"take", true}});
  EXPECT_EQ(second->connection.Last("denied")["what"], "lease");
  EXPECT_EQ(second->connection.Last("leases")["control"], first->id());
  now_ += kSecond;
  second->Say({{"type", "command"}, {"command", "start"}});
  EXPECT_EQ(second->connection.Last("denied")["what"], "command");
  EXPECT_TRUE(Inputs().empty());
  first->Say({{"type", "command"}, {"command", "start"}});
  const auto inputs = Inputs();
  ASSERT_EQ(inputs.size(), 1u);
  EXPECT_EQ(inputs[0].kind, InputKind::kStart);
  EXPECT_EQ(inputs[0].client, first->id());
  first->Say({{"type", "lease"}, {"what", "control"}, {"take", false}});
  EXPECT_TRUE(second->connection.Last("leases")["control"].is_null());
  second->Say({{"type", "lease"}, {"what", "control"}, {"take", true}});
  EXPECT_EQ(first->connection.Last("leases")["control"], second->id());
}

TEST_F(HubTest, ALeaseEndsThreeSecondsAfterTheLastHeartbeat) {
  auto page = Controller();
  now_ += 2 * kSecond;
  page->Say({{"type", "heartbeat"}});
  now_ += 3 * kSecond - 1;
  hub_->Tick();
  EXPECT_EQ(page->connection.Last("leases")["control"], page->id());
  now_ += 1;
  hub_->Tick();
  EXPECT_TRUE(page->connection.Last("leases")["control"].is_null());
  page->Say({{"type", "command"}, {"command", "reset"}});
  EXPECT_TRUE(Inputs().empty());
}

// A message arrives after a lease has ended and before the next tick. Whatever the message is, all
// pages are notified that the lease is free, and any of them may take it.
TEST_F(HubTest, AnEndedLeaseIsToldWhoeverSpeaksFirst) {
  const Json heartbeat = {{"type", "heartbeat"}};
  const Json other_lease = {{"type", "lease"}, {"what", "operator"}, {"take", true}};
  for (const Json& first : {heartbeat, other_lease}) {
    for (const bool holder_speaks : {false, true}) {
      auto holder = Controller();
      auto other = Admit();
      ASSERT_EQ(other->connection.Last("leases")["control"], holder->id());
      now_ += 3 * kSecond;
      (holder_speaks ? holder : other)->Say(first);
      EXPECT_TRUE(other->connection.Last("leases")["control"].is_null());
      EXPECT_TRUE(holder->connection.Last("leases")["control"].is_null());
      other->Say({{"type", "lease"}, {"what", "control"}, {"take", true}});
      EXPECT_EQ(holder->connection.Last("leases")["control"], other->id());
      hub_->Revoke(LeaseKind::kControl);
      hub_->Revoke(LeaseKind::kOperator);
    }
  }
}

// An ended lease commands nothing, even between two ticks of the server.
TEST_F(HubTest, AnEndedLeaseCommandsNothingEvenBeforeTheTick) {
  auto page = Controller();
  now_ += 3 * kSecond;
  page->Say({{"type", "command"}, {"command", "start"}});
  EXPECT_TRUE(Inputs().empty());
}

TEST_F(HubTest, ALeaseWaitsForItsHolderToReconnect) {
  auto page = Controller();
  const Json token = page->connection.Last("welcome")["token"];
  auto other = Admit();
  page.reset();
  other->Say({{"type", "lease"}, {"what", "control"}, {"take", true}});
  EXPECT_EQ(other->connection.CountOf("denied"), 1u);
  auto back = Connect();
  back->Say({{"type", "hello"}, {"token", token}});
  EXPECT_EQ(back->connection.Last("welcome")["leases"]["control"], back->id());
}

TEST_F(HubTest, TheConsoleMayFreeALease) {
  auto page = Controller();
  hub_->Revoke(LeaseKind::kControl);
  EXPECT_TRUE(page->connection.Last("leases")["control"].is_null());
  page->Say({{"type", "command"}, {"command", "start"}});
  EXPECT_TRUE(Inputs().empty());
}

TEST_F(HubTest, TheConsoleThrowsAClientOutForGood) {
  auto page = Controller();
  auto other = Admit();
  const Json token = page->connection.Last("welcome")["token"];
  const std::string code = admission_.code();
  EXPECT_FALSE(hub_->Kick(99, {1, 0}));
  EXPECT_TRUE(hub_->Kick(page->id(), {2, 0}));
  EXPECT_EQ(page->connection.closed, CloseCode::kRefused);
  EXPECT_TRUE(other->connection.Last("leases")["control"].is_null());
  page->Say({{"type", "command"}, {"command", "start"}});
  EXPECT_TRUE(Inputs().empty());
  for (const Json& hello :
       {Json{{"type", "hello"}, {"token", token}}, Json{{"type", "hello"}, {"code", code}}}) {
    auto back = Connect();
    back->Say(hello);
    EXPECT_FALSE(back->connection.admitted);
  }
  EXPECT_FALSE(other->connection.closed);
  auto with_new_code = Connect();
  with_new_code->Say({{"type", "hello"}, {"code", admission_.code()}});
  EXPECT_TRUE(with_new_code->connection.admitted);
}

// A client with the code may have obtained more tokens than the one in use.
TEST_F(HubTest, WhoIsThrownOutHasNoTokenInReserve) {
  auto page = Controller();
  const std::string mine = page->connection.Last("welcome")["token"];
  auto before = Connect();
  before->Say({{"type", "hello"}, {"code", admission_.code()}});
  const Json reserve = before->connection.Last("welcome")["token"];
  before.reset();
  auto bad = Connect();
  bad->Say({{"type", "hello"}, {"code", admission_.code()}});
  ASSERT_TRUE(hub_->Kick(bad->id(), {1, 0}));
  auto back = Connect();
  back->Say({{"type", "hello"}, {"token", reserve}});
  EXPECT_FALSE(back->connection.admitted);
  // A client that stays receives a new token, keeps its leases, and can reconnect with the new
  // token.
  const std::string renewed = page->connection.Last("token")["token"];
  EXPECT_NE(renewed, mine);
  EXPECT_EQ(page->connection.Last("leases")["control"], page->id());
  page.reset();
  auto again = Connect();
  again->Say({{"type", "hello"}, {"token", renewed}});
  ASSERT_TRUE(again->connection.admitted);
  EXPECT_EQ(again->connection.Last("leases")["control"], again->id());
  EXPECT_TRUE(bad->connection.Last("token").is_null());
}

TEST_F(HubTest, TheConsoleThrowsEverybodyOut) {
  auto page = Controller();
  auto other = Admit();
  const Json token = other->connection.Last("welcome")["token"];
  hub_->KickAll({1, 0});
  for (const auto* each : {&page, &other})
    EXPECT_EQ((*each)->connection.closed, CloseCode::kRefused);
  auto back = Connect();
  back->Say({{"type", "hello"}, {"token", token}});
  EXPECT_FALSE(back->connection.admitted);
}

// A machine on the network that guesses PINs does not keep other machines out.
TEST_F(HubTest, WrongPinsCountForTheirAddressAlone) {
  const std::string pin = admission_.IssuePin(Role::kOperator, now_);
  for (int i = 0; i < 20; ++i) {
    auto guesser = Connect();
    guesser->connection.address = "192.0.2.66";
    guesser->Say({{"type", "hello"}, {"pin", pin == "123456" ? "123457" : "123456"}});
    EXPECT_EQ(guesser->connection.closed, CloseCode::kRefused);
  }
  auto headset = Connect();
  headset->Say({{"type", "hello"}, {"pin", pin}});
  EXPECT_TRUE(headset->connection.admitted);
}

TEST_F(HubTest, OneTokenTakesNotAllSeats) {
  const std::string token = admission_.IssueToken(Role::kLook);
  std::vector<std::unique_ptr<Page>> pages;
  for (std::size_t k = 0; k <= Hub::kMostOfOneToken; ++k) {
    pages.push_back(Connect());
    pages.back()->Say({{"type", "hello"}, {"token", token}});
    EXPECT_EQ(pages.back()->connection.admitted, k < Hub::kMostOfOneToken);
  }
  EXPECT_EQ(pages.back()->connection.closed, CloseCode::kTryLater);
}

TEST_F(HubTest, LookersLeaveSeatsForOthers) {
  std::vector<std::unique_ptr<Page>> pages;
  for (std::size_t k = 0; k < Hub::kMostClients - Hub::kKeptSeats; ++k)
    pages.push_back(Admit(Role::kLook));
  auto late = Connect();
  late->Say({{"type", "hello"}, {"token", admission_.IssueToken(Role::kLook)}});
  EXPECT_EQ(late->connection.closed, CloseCode::kTryLater);
  Admit(Role::kControl);
}

// If a connection drops silently, the server may detect it much later than the page does.
TEST_F(HubTest, WhoComesBackBeforeTheServerNoticedKeepsItsLease) {
  auto page = Controller();
  const Json token = page->connection.Last("welcome")["token"];
  now_ += 2'800'000'000;
  auto again = Connect();
  again->Say({{"type", "hello"}, {"token", token}});
  EXPECT_EQ(again->connection.Last("leases")["control"], again->id());
  now_ += kSecond;
  hub_->Tick();
  again->Say({{"type", "heartbeat"}});
  EXPECT_EQ(again->connection.Last("leases")["control"], again->id());
  page.reset();
  EXPECT_EQ(again->connection.Last("leases")["control"], again->id());
}

// A second page of the same person does not take a lease that the first page still uses.
TEST_F(HubTest, AnotherPageOfTheSameTokenTakesNothingFromOneThatTalks) {
  auto page = Controller();
  const Json token = page->connection.Last("welcome")["token"];
  now_ += kSecond;
  auto other = Connect();
  other->Say({{"type", "hello"}, {"token", token}});
  EXPECT_EQ(other->connection.Last("leases")["control"], page->id());
}

TEST_F(HubTest, TheEndIsToldToWhoIsThereAndToWhoComes) {
  auto page = Controller();
  auto stranger = Connect();
  hub_->Publish(std::make_shared<const std::string>("last"), RunState::kHeld);
  hub_->EndRun("The run is finished.", false);
  EXPECT_EQ(page->connection.Last("ended")["text"], "The run is finished.");
  EXPECT_EQ(page->connection.closed, CloseCode::kGoingAway);
  EXPECT_FALSE(stranger->connection.closed);
  EXPECT_TRUE(stranger->connection.texts.empty());
  auto late = Admit();
  EXPECT_EQ(late->connection.newest, "last");
  EXPECT_EQ(late->connection.Last("ended")["text"], "The run is finished.");
  EXPECT_EQ(late->connection.closed, CloseCode::kGoingAway);
  EXPECT_EQ(late->connection.Last("ended")["results_follow"], false);
}

TEST_F(HubTest, PagesHearThatResultsFollow) {
  auto page = Controller();
  hub_->EndRun("The run ended as planned.", true);
  EXPECT_EQ(page->connection.Last("ended")["results_follow"], true);
}

TEST_F(HubTest, RolesBoundWhatMayBeTaken) {
  auto look = Admit(Role::kLook);
  for (const char* what : {"control", "operator"})
    look->Say({{"type", "lease"}, {"what", what}, {"take", true}});
  auto hands = Admit(Role::kOperator);
  hands->Say({{"type", "lease"}, {"what", "control"}, {"take", true}});
  EXPECT_EQ(hands->connection.CountOf("denied"), 1u);
  hands->Say({{"type", "lease"}, {"what", "operator"}, {"take", true}});
  EXPECT_EQ(look->connection.Last("leases")["operator"], hands->id());
  EXPECT_TRUE(look->connection.Last("leases")["control"].is_null());
}

TEST_F(HubTest, ParametersMustBeInRange) {
  auto page = Controller();
  page->Say({{"type", "parameter"}, {"parameter", "damping_ratio"}, {"value", 2.01}});
  EXPECT_EQ(page->connection.Last("denied")["what"], "parameter");
  page->Say({{"type", "parameter"}, {"parameter", "damping_ratio"}, {"value", 1.5}});
  const auto inputs = Inputs();
  ASSERT_EQ(inputs.size(), 1u);
  EXPECT_EQ(inputs[0].kind, InputKind::kParameter);
  EXPECT_EQ(inputs[0].parameter, Parameter::kDampingRatio);
  EXPECT_EQ(inputs[0].value, 1.5);
}

TEST_F(HubTest, WithRealArmsCommandsAreGivenAtTheConsole) {
  HubSetup setup = TestSetup();
  setup.rules = RulesOfRealArms();
  Make(setup);
  auto page = Controller();
  page->Say({{"type", "command"}, {"command", "start"}});
  EXPECT_EQ(page->connection.Last("denied")["what"], "command");
  EXPECT_TRUE(Inputs().empty());
}

// ---- hand ---------------------------------------------------------------------------------------

TEST_F(HubTest, TheOperatorsHandReachesTheRun) {
  auto page = Admit(Role::kOperator);
  page->Say(Hand("left"));
  EXPECT_EQ(page->connection.Last("denied")["what"], "hand");
  page->Say({{"type", "lease"}, {"what", "operator"}, {"take", true}});
  page->Say(Hand("left"));
  page->Say(Hand("right"));  // this handle does not exist
  const auto inputs = Inputs();
  ASSERT_EQ(inputs.size(), 1u);
  EXPECT_EQ(inputs[0].kind, InputKind::kHand);
  EXPECT_EQ(inputs[0].hand, 0);
  EXPECT_EQ(inputs[0].grip, 1);
  EXPECT_EQ(inputs[0].p[2], 0.3);
}

TEST_F(HubTest, AHandSpeaksAtMostNinetyTimesASecond) {
  auto page = Admit(Role::kOperator);
  page->Say({{"type", "lease"}, {"what", "operator"}, {"take", true}});
  std::size_t taken = 0;
  for (int i = 0; i < 10 * 180; ++i) {  // ten seconds with 180 messages each
    now_ += kSecond / 180;
    if (i % 180 == 0) page->Say({{"type", "heartbeat"}});
    page->Say(Hand("left"));
    taken += Inputs().size();
  }
  EXPECT_FALSE(page->connection.closed);
  EXPECT_LE(taken, 900u + 90 / 4 + 1);
  EXPECT_GE(taken, 800u);
}

TEST_F(HubTest, AScenarioWithAnotherOperatorTakesNoHands) {
  HubSetup setup = TestSetup();
  setup.browser_operator = false;
  Make(setup);
  auto page = Admit(Role::kOperator);
  page->Say({{"type", "lease"}, {"what", "operator"}, {"take", true}});
  page->Say(Hand("left"));
  EXPECT_TRUE(Inputs().empty());
}

// ---- display ------------------------------------------------------------------------------------

TEST_F(HubTest, EverybodyAdmittedSeesTheNewestState) {
  auto early = Admit(Role::kLook);
  auto outside = Connect();
  hub_->Publish(std::make_shared<const std::string>("one"), RunState::kRun);
  EXPECT_EQ(early->connection.newest, "one");
  EXPECT_EQ(outside->connection.newest, "");
  EXPECT_EQ(Admit(Role::kLook)->connection.newest, "one");
}

TEST_F(HubTest, PingsAreAnsweredTenTimesASecond) {
  auto page = Admit();
  for (int i = 0; i < 100; ++i) {
    now_ += kSecond / 100;
    page->Say({{"type", "ping"}, {"page_ms", 5}});
  }
  EXPECT_LE(page->connection.CountOf("pong"), 13u);
  EXPECT_GE(page->connection.CountOf("pong"), 10u);
  EXPECT_EQ(page->connection.Last("pong")["page_ms"], 5.0);
}

TEST_F(HubTest, TellsTheRunOfHeadsetsAndOfTheirSilence) {
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
  // The frame of the page that has been silent longest.
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

// A page may keep sending messages although its picture is frozen.
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
  // A picture cannot be newer than the present.
  EXPECT_EQ(mailbox_.immersive_frame_ns.load(), now_);
}

// When the session ends, the wearer sees as little as after a lost connection. If nothing moves,
// this does not matter to the run.
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

TEST_F(HubTest, APageWithControlEndsARunOfSimulatedArms) {
  HubSetup setup = TestSetup();
  Make(setup);
  const Json end = {{"type", "command"}, {"command", "end"}};
  auto other = Admit();
  auto page = Controller();
  other->Say(end);
  EXPECT_EQ(other->connection.Last("denied")["reason"], "Take control first.");
  EXPECT_TRUE(Inputs().empty());
  page->Say(end);
  const auto inputs = Inputs();
  ASSERT_EQ(inputs.size(), 1u);
  EXPECT_EQ(inputs[0].kind, InputKind::kStop);
  EXPECT_EQ(inputs[0].value, kEndAsPlanned);

  other.reset();
  page.reset();
  setup.rules = RulesOfRealArms();
  Make(setup);
  auto real = Controller();
  real->Say(end);
  EXPECT_EQ(real->connection.CountOf("denied"), 1u);
  EXPECT_TRUE(Inputs().empty());
}

TEST_F(HubTest, AScenarioIsChosenAtRestByThePageWithControl) {
  HubSetup setup = TestSetup();
  setup.scenarios = {"first", "second"};
  Make(setup);
  const Json choice = {{"type", "scenario"}, {"name", "second"}};
  const auto state = std::make_shared<const std::string>("state");
  auto other = Admit();
  auto page = Controller();
  hub_->Publish(state, RunState::kRun);
  page->Say(choice);
  EXPECT_EQ(page->connection.Last("denied")["reason"],
            "End or stop this run first, then choose a scenario.");
  hub_->Publish(state, RunState::kIdle);
  now_ += kSecond;
  other->Say(choice);
  EXPECT_EQ(other->connection.Last("denied")["what"], "scenario");
  now_ += kSecond;
  page->Say({{"type", "heartbeat"}});
  page->Say({{"type", "scenario"}, {"name", "third"}});
  EXPECT_TRUE(Inputs().empty());
  page->Say(choice);
  const auto inputs = Inputs();
  ASSERT_EQ(inputs.size(), 1u);
  EXPECT_EQ(inputs[0].kind, InputKind::kScenario);
  EXPECT_EQ(inputs[0].value, 1);
  for (const RunState at_rest : {RunState::kHeld, RunState::kUnpowered}) {
    hub_->Publish(state, at_rest);
    page->Say(choice);
    EXPECT_EQ(Inputs().size(), 1u) << Name(at_rest);
  }

  other.reset();
  page.reset();
  setup.rules = RulesOfRealArms();
  Make(setup);
  auto real = Controller();
  hub_->Publish(state, RunState::kIdle);
  real->Say(choice);
  EXPECT_TRUE(Inputs().empty());
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

TEST_F(HubTest, TellsTheConsoleWhoIsInAndWhatTheySayOfTheirDelays) {
  auto page = Admit();
  page->Say({{"type", "latency"}, {"offset_ms", 1}, {"received_ms", 2}, {"rendered_ms", 3}});
  page->Say({{"type", "lease"}, {"what", "operator"}, {"take", true}});
  page->Say({{"type", "immersive"}, {"active", true}});
  ASSERT_EQ(hub_->Status().size(), 1u);
  const ClientStatus status = hub_->Status()[0];
  EXPECT_EQ(status.id, page->id());
  EXPECT_EQ(status.role, Role::kControl);
  EXPECT_EQ(status.holds, (std::array<bool, kLeases>{false, true}));
  EXPECT_TRUE(status.headset);
  EXPECT_EQ(status.latency.rendered_ms, 3);
  const auto inputs = Inputs();  // for the record
  ASSERT_EQ(inputs.size(), 1u);
  EXPECT_EQ(inputs[0].kind, InputKind::kLatency);
  EXPECT_EQ(inputs[0].client, page->id());
  EXPECT_EQ(inputs[0].p, (std::array<double, 3>{1, 2, 3}));
}

}  // namespace
}  // namespace predictor::viewer
