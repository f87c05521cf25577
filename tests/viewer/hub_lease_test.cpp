// Tests leases, which determine which page may command the run or move its hands, and until when.
#include <gtest/gtest.h>

#include "viewer/hub_fixture.h"

namespace predictor::viewer {
namespace {

TEST_F(HubTest, OnlyOneClientCommandsAtATime) {
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

// In this test, a message arrives after a lease has ended and before the next tick. Whatever the
// message is, the hub must notify all pages that the lease is free, and any page may take the
// lease.
TEST_F(HubTest, AnEndedLeaseIsReportedWhicheverClientSendsFirst) {
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

// A page whose lease has ended must not command anything, even between two ticks of the server.
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

// If a connection drops silently, the server may notice the loss much later than the page.
TEST_F(HubTest, AClientThatReconnectsBeforeTheServerNoticesKeepsItsLease) {
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

// A second page of the same person must not take a lease that the first page still uses.
TEST_F(HubTest, AnotherPageOfTheSameTokenTakesNoLeaseFromAnActivePage) {
  auto page = Controller();
  const Json token = page->connection.Last("welcome")["token"];
  now_ += kSecond;
  auto other = Connect();
  other->Say({{"type", "hello"}, {"token", token}});
  EXPECT_EQ(other->connection.Last("leases")["control"], page->id());
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

}  // namespace
}  // namespace predictor::viewer
