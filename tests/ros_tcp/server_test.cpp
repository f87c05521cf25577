// Tests the server over real sockets, as Unity's connector uses it.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>

#include "core/error.h"
#include "ros_tcp/golden.h"
#include "ros_tcp/unity.h"
#include "support/soak.h"

namespace predictor::ros_tcp {
namespace {

INSTANTIATE_TEST_SUITE_P(Dialects, RosTcp, testing::Values(RosDialect::kRos1, RosDialect::kRos2),
                         [](const auto& dialect) { return Name(dialect.param); });

TEST_P(RosTcp, GreetsFirstAndListsTopics) {
  Unity unity(server_->port());
  const RosFrame greeting = unity.Receive();
  EXPECT_EQ(greeting.destination, "__handshake");
  const Json json = Json::parse(greeting.payload);
  EXPECT_EQ(json["version"], "v0.7.0");
  EXPECT_EQ(Json::parse(json["metadata"].get<std::string>())["protocol"], Name(GetParam()));
  unity.Send("__topic_list", Json::object());
  const Json list = Json::parse(unity.Receive().payload);
  ASSERT_EQ(list["topics"].size(), list["types"].size());
  EXPECT_GE(list["topics"].size(), 10u);
}

TEST_P(RosTcp, SendsOnlySubscribedTopics) {
  Unity unity(server_->port());
  unity.Receive();
  unity.Send("__subscribe",
             {{"topic", "/predictor/joint_states"}, {"message_name", "sensor_msgs/JointState"}});
  for (int k = 0; k < 5; ++k) {
    const RosFrame frame = unity.Receive();
    ASSERT_EQ(frame.destination, "/predictor/joint_states");
    const double half = 0.5;
    EXPECT_NE(frame.payload.find(std::string(reinterpret_cast<const char*>(&half), 8)),
              std::string::npos);
  }
  unity.Send("__subscribe",
             {{"topic", "/predictor/markers"}, {"message_name", "visualization_msgs/Marker"}});
  std::map<std::string, int> seen;
  for (int k = 0; k < 60; ++k) ++seen[unity.Receive().destination];
  // For each joint state, the server must send four arrows and one circle.
  EXPECT_NEAR(seen["/predictor/markers"], 5 * seen["/predictor/joint_states"], 5);
  EXPECT_EQ(seen.size(), 2u);
  unity.Send("__remove_subscriber", {{"topic", "/predictor/markers"}});
  unity.Send("__topic_list", Json::object());
  while (unity.Receive().destination != "__topic_list") {
  }
  for (int k = 0; k < 20; ++k) EXPECT_EQ(unity.Receive().destination, "/predictor/joint_states");
}

TEST_P(RosTcp, AcceptsOnlyAStop) {
  Unity unity(server_->port());
  unity.Receive();
  std::map<std::string, std::string> golden = Golden();
  const std::string stop = golden[std::string("stop ") + Name(GetParam())];
  const std::string no_stop = golden[std::string("no_stop ") + Name(GetParam())];
  unity.Send("__publish", {{"topic", "/predictor/stop"}, {"message_name", "std_msgs/Bool"}});
  unity.Raw(Encode("/predictor/stop", no_stop));
  unity.Raw(Encode("/predictor/joint_states", stop + std::string(50, '\1')));
  unity.Send("__topic_list", Json::object());
  unity.Receive();
  EXPECT_EQ(mailbox_->stops.load(), 0u);
  unity.Raw(Encode("/predictor/stop", stop));
  unity.Send("__topic_list", Json::object());
  unity.Receive();
  EXPECT_EQ(mailbox_->stops.load(), 1u);
}

// The ROS-TCP endpoint of the paper's time would drop the connection after these messages.
TEST_P(RosTcp, SurvivesTheMessagesOfConnectors) {
  Unity unity(server_->port());
  unity.Receive();
  unity.Raw(std::string(8, '\0'));  // keep-alive
  for (const char* command :
       {"__remove_publisher", "__remove_ros_service", "__remove_unity_service", "__unity_service"})
    unity.Send(command, {{"topic", "/x"}});
  unity.Send("__request", {{"srv_id", 1}});
  EXPECT_EQ(unity.Receive().destination, "__error");
  unity.Raw(Encode("/some_service", "body"));
  unity.Send("__dance", Json::object());
  EXPECT_EQ(unity.Receive().destination, "__error");
  unity.Raw(Encode("__subscribe", "not json"));
  EXPECT_EQ(unity.Receive().destination, "__error");
  unity.Send("__subscribe", {{"topic", 5}});
  EXPECT_EQ(unity.Receive().destination, "__warn");
  unity.Send("__subscribe", {{"topic", "/predictor/state"}, {"message_name", "std_msgs/Int8"}});
  EXPECT_EQ(unity.Receive().destination, "__error");
  unity.Raw(Encode(std::string("__topic_list\0", 13), std::string("{}\0", 3)));
  EXPECT_EQ(unity.Receive().destination, "__topic_list");
}

TEST_P(RosTcp, ServesSeveralAndOutlivesThoseThatDoNotReadSoak) {
  Unity silent(server_->port());
  silent.Receive();
  for (const RosTopic& topic : topics_->list())
    silent.Send("__subscribe", {{"topic", topic.name}, {"message_name", topic.type}});
  {
    Unity broken(server_->port());
    broken.Raw(std::string(64, '\xff'));
    while (!broken.Receive().destination.empty()) {
    }
  }
  Unity reads(server_->port());
  reads.Receive();
  reads.Send("__subscribe", {{"topic", "/predictor/state"}});
  for (long k = 0; k < Count(120, 60L * 60 * 60); ++k) {
    if (k % 10 == 0) reads.KeepAlive(), silent.KeepAlive();
    const RosFrame frame = reads.Receive();
    ASSERT_EQ(frame.destination, "/predictor/state");
    ASSERT_NE(frame.payload.find("RUN"), std::string::npos);
  }
}

// The server must receive a stop request at any position among the frames.
TEST_P(RosTcp, AStopRightAfterAServiceCallIsTaken) {
  Unity unity(server_->port());
  unity.Receive();
  const std::string header = GetParam() == RosDialect::kRos2 ? std::string("\0\1\0\0", 4) : "";
  std::uint32_t stops = 0;
  for (const char* call : {"__request", "__response"}) {
    unity.Send(call, {{"srv_id", 1}});
    unity.Raw(Encode("/predictor/stop", header + std::string(1, '\1')));
    unity.Send("__topic_list", Json::object());
    while (unity.Receive().destination != "__topic_list") {
    }
    EXPECT_EQ(mailbox_->stops.load(), ++stops) << call;
  }
}

// Eight clients that vanished silently must not keep all others out.
TEST_P(RosTcp, ASilentClientMakesRoom) {
  std::vector<std::unique_ptr<Unity>> silent;
  for (int k = 0; k < 3; ++k) {
    silent.push_back(std::make_unique<Unity>(server_->port()));
    EXPECT_EQ(silent.back()->Receive().destination, "__handshake");
  }
  for (const auto& unity : silent) EXPECT_EQ(unity->Receive().destination, "");  // cut off
  Unity late(server_->port());
  EXPECT_EQ(late.Receive().destination, "__handshake");
}

// Clients that only keep the connection alive must give way to a newcomer. Clients that use their
// connection stay connected.
TEST_P(RosTcp, AnIdleClientGivesWayToANewOne) {
  Unity used(server_->port());
  used.Receive();
  used.Send("__subscribe", {{"topic", "/predictor/state"}});
  EXPECT_EQ(used.Receive().destination, "/predictor/state");
  std::vector<std::unique_ptr<Unity>> idle;
  for (int k = 0; k < 6; ++k) {
    idle.push_back(std::make_unique<Unity>(server_->port()));
    EXPECT_EQ(idle.back()->Receive().destination, "__handshake") << k;
    idle.back()->KeepAlive();
    used.KeepAlive();
  }
  for (int k = 0; k < 4; ++k) EXPECT_EQ(idle[k]->Receive().destination, "") << k;
  for (int k = 0; k < 20; ++k) EXPECT_EQ(used.Receive().destination, "/predictor/state");
  // Two more clients take seats and use them, so that no seat is free.
  for (int k = 4; k < 6; ++k) {
    idle[k]->Send("__publish", {{"topic", "/predictor/stop"}, {"message_name", "std_msgs/Bool"}});
    idle[k]->Send("__topic_list", Json::object());
    EXPECT_EQ(idle[k]->Receive().destination, "__topic_list");
  }
  Unity late(server_->port());
  EXPECT_EQ(late.Receive().destination, "");
}

// The echoed bytes need not be valid text. One client's bytes must neither disturb other clients
// nor end the server.
TEST_P(RosTcp, EchoesInvalidText) {
  Unity unity(server_->port());
  unity.Receive();
  // The 40th byte is the first half of a letter.
  const std::string cut = std::string(39, 'x') + "\u00e4";
  for (const std::string& name : {std::string("\xff\xfe"), cut}) {
    unity.Raw(Encode("__" + name, "[]"));
    EXPECT_EQ(unity.Receive().destination, "__error");
    unity.Raw(Encode("__" + name, "{}"));
    EXPECT_EQ(unity.Receive().destination, "__error");
  }
  for (const char* command : {"__publish", "__subscribe", "__ros_service"}) {
    const Json json = {{"topic", std::string(99, 'x') + "\u00e4"}};
    unity.Send(command, json);
    EXPECT_NE(unity.Receive().destination, "") << command;
  }
  unity.Send("__topic_list", Json::object());
  EXPECT_EQ(unity.Receive().destination, "__topic_list");
}

// The client sends frames of random bytes, complete and broken, with and without the name of a
// command.
TEST_P(RosTcp, AnyBytesEndNoOtherClientSoak) {
  std::mt19937 random(7);
  const auto bytes = [&random](std::size_t most) {
    std::string text(random() % (most + 1), '\0');
    for (char& c : text) c = static_cast<char>(random());
    return text;
  };
  const std::vector<std::string> names = {"__publish",      "__subscribe", "__ros_service",
                                          "__request",      "__response",  "__dance",
                                          "/predictor/stop"};
  Unity watches(server_->port());
  watches.Receive();
  watches.Send("__subscribe", {{"topic", "/predictor/state"}});
  for (long k = 0; k < Count(200, 20'000); ++k) {
    watches.KeepAlive();
    ASSERT_EQ(watches.Receive().destination, "/predictor/state");
    Unity wild(server_->port());
    for (int frame = 0; frame < 20; ++frame) {
      const std::string& name = names[random() % names.size()];
      const std::string json =
          "{\"topic\":\"" + bytes(200) + "\",\"message_name\":\"" + bytes(90) + "\"}";
      switch (random() % 4) {
        case 0:
          wild.Raw(Encode("__" + bytes(60), json));
          break;
        case 1:
          wild.Raw(Encode(name, bytes(300)));
          break;
        case 2:
          wild.Raw(Encode(name, json));
          break;
        default:
          if (random() % 10 == 0) wild.Raw(bytes(100));
      }
    }
  }
}

// After a stop, the state must list the cause in a fixed order, followed by the cause that removed
// the power.
TEST(RosTcpState, ReportsWhyTheArmsStand) {
  const RosTopics topics(Scenario{}, {}, Vector3::Zero());
  const auto reported = [&topics](const TickRecord& record) {
    for (const RosPublication& sent : topics.Publish(record, RosDialect::kRos2, 0, 0))
      if (topics.list()[sent.topic].name == "/predictor/state")
        return std::string(sent.payload.begin() + 8,
                           sent.payload.end() - 1);  // skips the header, the length and the NUL
    return std::string();
  };
  TickRecord record{};
  record.state = RunState::kRun;
  EXPECT_EQ(reported(record), "RUN");
  record.state = RunState::kHeld;
  record.cause = StopCause::kDeadline;
  record.cause_hand = -1;
  record.cause_value = 3;
  record.cause_limit = 2;
  EXPECT_EQ(reported(record), "HELD deadline - 3 2");
  record.state = RunState::kUnpowered;
  record.harder = {StopCause::kStale, 1, Quantity::kArmAge, 1, {}, 0.0214, 0.02};
  EXPECT_EQ(reported(record), "UNPOWERED deadline - 3 2 stale right 0.0214 0.02");
}

TEST(RosTcpOptions, OfNonsenseAreRefused) {
  Scenario s;
  const RosTopics topics(s, {}, Vector3::Zero());
  Shared<RunBoard> board;
  Shared<StopMailbox> mailbox;
  for (const char* network : {"", "everywhere", "192.0.2.0/33", "192.0.2/24", "192.0.2.0/x"})
    EXPECT_THROW(RosTcpServer({0, {network}}, &topics, &*board, &*mailbox), InputError) << network;
  // These networks contain more addresses than any private network. The message must suggest a
  // valid setting.
  for (const char* network :
       {"0.0.0.0/0", "0.0.0.0/1", "128.0.0.0/1", "10.0.0.0/7", "0.0.0.0", "::/0", "::"}) {
    try {
      RosTcpServer({0, {network}}, &topics, &*board, &*mailbox);
      ADD_FAILURE() << network;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("192.168.1.0/24"), std::string::npos)
          << error.what();
    }
  }
  EXPECT_NO_THROW(RosTcpServer({0, {"10.0.0.0/8"}}, &topics, &*board, &*mailbox));
  RosTcpServer first({0, {}}, &topics, &*board, &*mailbox);
  EXPECT_THROW(RosTcpServer({first.port(), {}}, &topics, &*board, &*mailbox), InputError);
}

}  // namespace
}  // namespace predictor::ros_tcp
