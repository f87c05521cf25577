// A hub with its admission and mailbox, fake connections that replace the network, and a clock that
// the test sets.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/hub.h"

namespace predictor::viewer {

struct FakeConnection : Connection {
  void SendText(std::string text) override { texts.push_back(Json::parse(text)); }
  void SendNewest(std::uint32_t, MessageKind kind,
                  std::shared_ptr<const std::string> message) override {
    (kind == MessageKind::kText ? newest_text : newest) = *message;
  }
  void Close(CloseCode code, std::string) override { closed = code; }
  void Admitted() override { admitted = true; }
  std::string peer() const override { return address; }

  // Returns the last message of this type, or null if there was none.
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
  static constexpr std::uint64_t kSecond = 1'000'000'000;

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

  static OperatingRules RulesOfRealArms() {
    Scenario scenario;
    scenario.device.type = "real";
    return RulesFor(scenario);
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

}  // namespace predictor::viewer
