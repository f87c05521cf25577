// Tests that only the experimenter's page receives the scenario's events before they begin.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "scenario/own_parameters.h"
#include "viewer/hub_fixture.h"
#include "viewer/scene_description.h"
#include "viewer/test_server.h"

namespace predictor::viewer {
namespace {

using testing_client::WebSocket;

// The numbers of this fixture occur nowhere else in the scene or in its models.
const std::vector<std::string> kFixture = {
    "environment.fixtures=[{name: wall, shape: box, size: [0.4321, 0.1, 0.2], xyz: [2, 0, 0]}]"};
const std::vector<std::string> kEvents = {
    kFixture[0],
    "events=[{event: power_loss, trigger: {after: 3.217, window: 2}, duration: 1.739},"
    " {event: obstacle_appears, fixture: wall, trigger: {force: 12.39, gripping: true}}]"};
constexpr std::uint16_t kPowerLoss = 0b01, kWallAppears = 0b10;

Json EventsIn(const std::string& text) { return Json::parse(text)["events"]; }

class EventsOnThePage : public testing::Test {
 protected:
  static TestServer::Setup SetupWithEvents() {
    TestServer::Setup setup;
    setup.overrides = kEvents;
    setup.overrides.push_back("operator.type=browser");
    return setup;
  }

  // Publishes the next tick and waits until the page has its state. Also collects everything else
  // that the page receives before this state.
  void Tick(WebSocket* page, double run_time, std::uint16_t events) {
    TickRecord record = {};
    record.tick = ++tick_;
    record.run_time = run_time;
    record.state = RunState::kRun;
    record.events = events;
    server_.Do([&](ViewerApp&) {
      server_.Publish(record);
      return 0;
    });
    for (;;) {
      const auto message = page->Next();
      ASSERT_TRUE(message);
      received_ += message->payload;
      if (message->opcode != 2) continue;
      std::uint64_t tick = 0;
      std::memcpy(&tick, message->payload.data(), sizeof tick);
      if (tick == tick_) return;
    }
  }
  static std::string Ask(WebSocket* page, const char* answer) {
    page->SendText(R"({"type":"experimenter"})");
    return page->NextText(answer).value_or("");
  }

  TestServer server_{SetupWithEvents()};
  std::uint64_t tick_ = 0;
  std::string received_;
};

// Returns whether the bytes contain information about an event, such as its name, its trigger, its
// duration, or the fixture that it lets appear.
bool MentionsAnEvent(const std::string& bytes) {
  for (const char* what : {"power_loss", "obstacle_appears", "3.217", "1.739", "12.39", "0.4321",
                           "\"wall\"", "trigger", "\"events\":["})
    if (bytes.find(what) != std::string::npos) return true;
  return false;
}

TEST_F(EventsOnThePage, NoByteForASubjectMentionsAnEventBeforeItBegins) {
  for (const Role role : {Role::kLook, Role::kOperator, Role::kControl}) {
    SCOPED_TRACE(Name(role));
    WebSocket page(server_.port()), experimenter(server_.port());
    page.SendText(R"({"type":"hello","token":")" + server_.Token(role) + "\"}");
    experimenter.Hello(server_.code());
    EXPECT_TRUE(MentionsAnEvent(Ask(&experimenter, "events")));
    received_.clear();
    Tick(&page, 0, 0);
    Tick(&page, 2, 0);
    ASSERT_NE(received_.find("\"welcome\""), std::string::npos);
    EXPECT_FALSE(MentionsAnEvent(received_)) << received_;
    received_.clear();
    // Without the simulation, the description of a hazard is its name.
    Tick(&page, 4, kPowerLoss);
    const std::string acting = R"({"type":"acting","acting":["power_loss"]})";
    const std::size_t at = received_.find(acting);
    ASSERT_NE(at, std::string::npos) << received_;
    EXPECT_FALSE(MentionsAnEvent(received_.erase(at, acting.size()))) << received_;
    // The wall has now appeared, so the page must draw it.
    Tick(&page, 5, kWallAppears);
    EXPECT_NE(received_.find("0.4321"), std::string::npos);
    Tick(&page, 0, 0);  // after a reset, the event is to come again
    WebSocket later(server_.port());
    const std::string welcome = later.Hello(server_.code());
    ASSERT_FALSE(welcome.empty());
    EXPECT_FALSE(MentionsAnEvent(welcome)) << welcome;
    EXPECT_EQ(Json::parse(welcome)["scene"]["acting"], Json::array());
  }
}

TEST_F(EventsOnThePage, TheExperimentersPageShowsEventsWithTriggersAndTimes) {
  WebSocket page(server_.port());
  page.Hello(server_.code());
  Json events = EventsIn(Ask(&page, "events"));
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0]["event"], "power_loss");
  EXPECT_EQ(events[0]["trigger"], "at a random time between 3.217 and 5.217 s");
  EXPECT_EQ(events[1]["trigger"], "when a hand's force exceeds 12.39 N and every hand grips");
  for (const Json& event : events) EXPECT_TRUE(event["begin"].is_null());
  const auto after = [&](double run_time, std::uint16_t acting) {
    received_.clear();
    Tick(&page, run_time, acting);
    const std::size_t at = received_.find(R"({"type":"events")");
    if (at == std::string::npos) return Json();
    return EventsIn(received_.substr(at, received_.find("]}", at) + 2 - at));
  };
  EXPECT_TRUE(after(0, 0).is_null());  // nothing new
  events = after(4, kPowerLoss);
  EXPECT_EQ(events[0]["begin"], 4.0);
  EXPECT_TRUE(events[0]["end"].is_null());
  EXPECT_TRUE(events[1]["begin"].is_null());
  events = after(5.5, kWallAppears);
  EXPECT_EQ(events[0]["end"], 5.5);
  EXPECT_EQ(events[1]["begin"], 5.5);
  EXPECT_TRUE(after(6, kWallAppears).is_null());
  events = after(0, 0);  // after a reset
  EXPECT_TRUE(events[0]["begin"].is_null());
}

TEST_F(EventsOnThePage, OnlyTheRoleControlMayAsk) {
  for (const Role role : {Role::kLook, Role::kOperator}) {
    WebSocket page(server_.port());
    page.SendText(R"({"type":"hello","token":")" + server_.Token(role) + "\"}");
    const std::string denied = Ask(&page, "denied");
    EXPECT_NE(denied.find("may not see the events to come"), std::string::npos) << denied;
    received_.clear();
    Tick(&page, 4, 0);
    EXPECT_FALSE(MentionsAnEvent(received_)) << received_;
  }
}

TEST_F(EventsOnThePage, HasAnAddressOfItsOwn) {
  const auto page = testing_client::Get(server_.port(), "/experimenter");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, testing_client::Get(server_.port(), "/").body);
}

TEST(Scene, IsTheSameWithAndWithoutEventsBeforeTheyBegin) {
  const std::filesystem::path file =
      std::filesystem::path(PREDICTOR_SOURCE_DIR) / "scenarios/box_9kg.yaml";
  AssetStore with, without;
  const Scenario planned = LoadScenario(file, kEvents);
  EXPECT_EQ(DescribeScene(planned, Vector3::Zero(), &with),
            DescribeScene(LoadScenario(file), Vector3::Zero(), &without));
  EXPECT_TRUE(DescribeFixtures(planned, kPowerLoss).empty());
  EXPECT_EQ(DescribeFixtures(planned, kWallAppears),
            DescribeFixtures(LoadScenario(file, kFixture), 0));
}

// The bits of a record's `events` number the entries of the scenario, and `latest_event` numbers
// the hazards. Here each entry has a number that differs from that of its hazard, and the entries
// are not in the order of the hazards.
TEST(Scene, DescribesTheEventsThatActWithTheOneThatBeganLastAtTheEnd) {
  const ParameterKind brakes = {"brakes_close", "the brakes close", nullptr};
  const ParameterKind friction = {"wrong_friction", "the friction is wrong", nullptr};
  const ParameterKind opens = {"release_object", "the gripper opens", nullptr};
  const ParameterKind* kinds[] = {&brakes, &friction, &opens};
  const ParameterKinds declared = Hazards();
  DeclareHazards(kinds);
  Scenario scenario;
  scenario.events.resize(3);
  scenario.events[0].event = opens.name;     // hazard 3
  scenario.events[1].event = brakes.name;    // hazard 1
  scenario.events[2].event = friction.name;  // hazard 2
  const auto acting = [&](std::uint16_t events, std::uint8_t latest) {
    return DescribeActing(scenario, events, latest).dump();
  };
  EXPECT_EQ(acting(0b000, 0), "[]");
  EXPECT_EQ(acting(0b000, 3), "[]");
  EXPECT_EQ(acting(0b001, 3), R"(["the gripper opens"])");
  EXPECT_EQ(acting(0b010, 1), R"(["the brakes close"])");
  EXPECT_EQ(acting(0b100, 2), R"(["the friction is wrong"])");
  EXPECT_EQ(acting(0b011, 3), R"(["the brakes close","the gripper opens"])");
  EXPECT_EQ(acting(0b011, 1), R"(["the gripper opens","the brakes close"])");
  EXPECT_EQ(acting(0b011, 2), R"(["the gripper opens","the brakes close"])");  // 2 is over
  DeclareHazards(declared);
}

// A plan that begins in the middle of a run does not contain the events that are already over.
TEST(EventPlan, SaysWhetherItIsComplete) {
  const Scenario scenario =
      LoadScenario(std::filesystem::path(PREDICTOR_SOURCE_DIR) / "scenarios/box_9kg.yaml", kEvents);
  const auto complete = [](const EventPlan& plan) { return Json::parse(plan.Text())["complete"]; };
  EventPlan plan(scenario);
  EXPECT_EQ(complete(plan), true);
  TickRecord record = {};
  record.run_time = 7;
  plan.See(record);
  EXPECT_EQ(complete(plan), false);
  record.run_time = 0;
  plan.See(record);
  EXPECT_EQ(complete(plan), true);
}

// ---- who moves the hands or wears a headset
// ------------------------------------------------------

class ExperimenterHub : public HubTest {
 protected:
  ExperimenterHub() { hub_->PublishEvents(R"({"type":"events","events":[]})"); }
  static Json Request() { return {{"type", "experimenter"}}; }
  static Json Operator() { return {{"type", "lease"}, {"what", "operator"}, {"take", true}}; }
  void Change() {
    hub_->PublishEvents(R"({"type":"events","n":)" + std::to_string(++changes_) + "}");
  }
  int changes_ = 0;
};

TEST_F(ExperimenterHub, ChangesReachThePagesThatAsked) {
  const auto asks = Admit(), other = Admit();
  asks->Say(Request());
  EXPECT_EQ(asks->connection.CountOf("events"), 1u);
  Change();
  EXPECT_EQ(asks->connection.Last("events")["n"], 1);
  hub_->PublishEvents(R"({"type":"events","n":1})");  // not a change
  EXPECT_EQ(asks->connection.CountOf("events"), 2u);
  EXPECT_EQ(other->connection.CountOf("events"), 0u);
}

TEST_F(ExperimenterHub, WhoMovesTheHandsMayNotAsk) {
  const auto page = Admit();
  page->Say(Operator());
  page->Say(Request());
  EXPECT_EQ(page->connection.Last("denied")["what"], "experimenter");
  Change();
  EXPECT_EQ(page->connection.CountOf("events"), 0u);
}

TEST_F(ExperimenterHub, AnExperimenterMayNotMoveTheHands) {
  const auto page = Admit();
  page->Say(Request());
  page->Say(Operator());
  EXPECT_EQ(page->connection.Last("denied")["what"], "lease");
  EXPECT_TRUE(page->connection.Last("leases")["operator"].is_null());
}

TEST_F(ExperimenterHub, AHeadsetReceivesNoFurtherEvents) {
  const auto page = Admit();
  page->Say(Request());
  page->Say({{"type", "immersive"}, {"active", true}});
  Change();
  EXPECT_EQ(page->connection.CountOf("events"), 1u);
  page->Say(Request());
  EXPECT_EQ(page->connection.Last("denied")["what"], "experimenter");
}

TEST_F(ExperimenterHub, AfterTheRunThereIsNothingToCome) {
  Make(TestSetup());
  const auto page = Admit();
  page->Say(Request());
  EXPECT_EQ(page->connection.Last("denied")["what"], "experimenter");
}

}  // namespace
}  // namespace predictor::viewer
