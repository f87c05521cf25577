// Tests which clients the hub admits and expels, and what it sends to every page.
#include "viewer/hub.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "viewer/hub_fixture.h"

namespace predictor::viewer {
namespace {

TEST_F(HubTest, WelcomesClientsWithTheCode) {
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

TEST_F(HubTest, RefusesAllOtherClients) {
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

TEST_F(HubTest, NothingIsAcceptedBeforeHello) {
  auto page = Connect();
  page->Say({{"type", "stop"}});
  EXPECT_EQ(page->connection.closed, CloseCode::kRefused);
  EXPECT_EQ(mailbox_.stops.load(), 0u);
  page->Say({{"type", "hello"}, {"code", admission_.code()}});  // too late
  EXPECT_FALSE(page->connection.admitted);
  hub_->Publish(std::make_shared<const std::string>("state"), RunState::kRun);
  EXPECT_EQ(page->connection.newest, "");
}

TEST_F(HubTest, AClientThatIsSilentForFiveSecondsIsDisconnected) {
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

TEST_F(HubTest, AnInvalidMessageEndsTheConnection) {
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
  for (std::size_t i = 0; i < Hub::kMaxClients; ++i) pages.push_back(Admit());
  auto late = Connect();
  late->Say({{"type", "hello"}, {"code", admission_.code()}});
  EXPECT_EQ(late->connection.closed, CloseCode::kTryLater);
  EXPECT_FALSE(late->connection.admitted);
  EXPECT_EQ(late->connection.CountOf("refused"), 0u);  // its code or token is valid
  pages.pop_back();
  EXPECT_EQ(hub_->clients(), 63u);
  Admit();
}

TEST_F(HubTest, TheConsoleRemovesAClientPermanently) {
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

// A client with the code may have obtained more tokens than the one that it uses.
TEST_F(HubTest, ARemovedClientHasNoOtherValidToken) {
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

TEST_F(HubTest, TheConsoleRemovesAllClients) {
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

// A machine on the network that guesses PINs must not keep other machines out.
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

TEST_F(HubTest, OneTokenCannotTakeAllSeats) {
  const std::string token = admission_.IssueToken(Role::kLook);
  std::vector<std::unique_ptr<Page>> pages;
  for (std::size_t k = 0; k <= Hub::kMaxClientsPerToken; ++k) {
    pages.push_back(Connect());
    pages.back()->Say({{"type", "hello"}, {"token", token}});
    EXPECT_EQ(pages.back()->connection.admitted, k < Hub::kMaxClientsPerToken);
  }
  EXPECT_EQ(pages.back()->connection.closed, CloseCode::kTryLater);
}

TEST_F(HubTest, ViewOnlyClientsLeaveSeatsForOthers) {
  std::vector<std::unique_ptr<Page>> pages;
  for (std::size_t k = 0; k < Hub::kMaxClients - Hub::kKeptSeats; ++k)
    pages.push_back(Admit(Role::kLook));
  auto late = Connect();
  late->Say({{"type", "hello"}, {"token", admission_.IssueToken(Role::kLook)}});
  EXPECT_EQ(late->connection.closed, CloseCode::kTryLater);
  Admit(Role::kControl);
}

TEST_F(HubTest, TheEndIsReportedToPresentAndLaterClients) {
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

TEST_F(HubTest, PagesAreNotifiedThatResultsFollow) {
  auto page = Controller();
  hub_->EndRun("The run ended as planned.", true);
  EXPECT_EQ(page->connection.Last("ended")["results_follow"], true);
}

TEST_F(HubTest, EveryAdmittedClientReceivesTheNewestState) {
  auto early = Admit(Role::kLook);
  auto outside = Connect();
  hub_->Publish(std::make_shared<const std::string>("one"), RunState::kRun);
  EXPECT_EQ(early->connection.newest, "one");
  EXPECT_EQ(outside->connection.newest, "");
  EXPECT_EQ(Admit(Role::kLook)->connection.newest, "one");
}

TEST_F(HubTest, EveryAdmittedClientReceivesTheNewestStateOfThePerson) {
  const auto early = Admit();
  hub_->PublishPerson(std::make_shared<const std::string>("{\"type\":\"person\",\"tick\":1}"));
  hub_->PublishPerson(std::make_shared<const std::string>("{\"type\":\"person\",\"tick\":2}"));
  const auto late = Admit(), stranger = Connect();
  for (const auto* page : {&early, &late})
    EXPECT_EQ(Json::parse((*page)->connection.newest_text)["tick"], 2);
  EXPECT_EQ(stranger->connection.newest_text, "");
  EXPECT_EQ(late->connection.Last("welcome")["features"], (Json{"headset", "person"}));
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

TEST_F(HubTest, ReportsClientsAndTheirDelaysToTheConsole) {
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
