// Tests the requests that pages may send to a run: stops, commands, parameters, scenarios and
// movements of the hands.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "core/choice.h"
#include "core/status.h"
#include "viewer/hub_fixture.h"

namespace predictor::viewer {
namespace {

TEST_F(HubTest, EveryClientMayStop) {
  auto page = Admit(Role::kLook);
  page->Say({{"type", "stop"}});
  EXPECT_EQ(mailbox_.stops.load(), 1u);
}

// A stop request has priority over the message limit, over a full mailbox, and even over a
// disconnection for flooding.
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

TEST_F(HubTest, AHandSendsAtMostNinetyMessagesPerSecond) {
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

TEST_F(HubTest, AScenarioWithAnotherOperatorAcceptsNoHands) {
  HubSetup setup = TestSetup();
  setup.browser_operator = false;
  Make(setup);
  auto page = Admit(Role::kOperator);
  page->Say({{"type", "lease"}, {"what", "operator"}, {"take", true}});
  page->Say(Hand("left"));
  EXPECT_TRUE(Inputs().empty());
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

}  // namespace
}  // namespace predictor::viewer
