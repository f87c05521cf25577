// Tests the person's states on their way to the pages.
#include <gtest/gtest.h>

#include "viewer/test_server.h"

namespace predictor::viewer {
namespace {

using testing_client::WebSocket;

TEST(PersonOnThePage, GetsTheNewestState) {
  const auto states = std::make_unique<EvaluationBoard>();
  PersonState state;
  for (state.tick = 10; state.tick <= 50; state.tick += 10) states->states.Publish(state);
  TestServer::Setup setup;
  setup.app.states = states.get();
  TestServer server(setup);
  WebSocket page(server.port());
  const std::string welcome = page.Hello(server.code());
  EXPECT_NE(welcome.find(R"("person":{"judged":true})"), std::string::npos) << welcome;
  const auto first = page.NextText("person");
  ASSERT_TRUE(first);
  EXPECT_NE(first->find(R"("tick":50,)"), std::string::npos) << *first;
  states->states.Publish(state);
  const auto second = page.NextText("person");
  ASSERT_TRUE(second);
  EXPECT_NE(second->find(R"("tick":60,)"), std::string::npos) << *second;
}

TEST(PersonOnThePage, ReceivesTheReasonWhyNothingIsJudged) {
  TestServer::Setup setup;
  setup.app.why_not_judged = "The place is not known.";
  TestServer server(setup);
  WebSocket page(server.port());
  const std::string welcome = page.Hello(server.code());
  EXPECT_NE(welcome.find(R"("person":{"judged":false,"why":"The place is not known."})"),
            std::string::npos)
      << welcome;
}

}  // namespace
}  // namespace predictor::viewer
