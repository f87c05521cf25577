#include "viewer/foxglove.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "models/robot.h"
#include "viewer/test_server.h"

namespace predictor::viewer {
namespace {

using testing_client::WebSocket;

std::string Path(const std::string& token) { return "/?token=" + token; }

TEST(Foxglove, NeedsATokenAndOneOfItsSubprotocols) {
  TestServer server;
  const std::string token = server.WatchToken();
  EXPECT_EQ(WebSocket(server.port(), "/", "foxglove.sdk.v1").status(), 401);
  EXPECT_EQ(WebSocket(server.port(), Path("wrong"), "foxglove.sdk.v1").status(), 401);
  EXPECT_EQ(WebSocket(server.port(), "/?x=" + token, "foxglove.sdk.v1").status(), 401);
  // A page's token must not be a part of an address.
  for (const Role role : {Role::kLook, Role::kOperator, Role::kControl})
    EXPECT_EQ(WebSocket(server.port(), Path(server.Token(role)), "foxglove.sdk.v1").status(), 401);
  EXPECT_EQ(WebSocket(server.port(), Path(token), "predictor.v1").status(), 400);
  EXPECT_EQ(WebSocket(server.port(), Path(token), "").status(), 400);
  for (const char* name : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    WebSocket client(server.port(), "/?a=b&token=" + token, std::string("other, ") + name);
    EXPECT_EQ(client.status(), 101);
    EXPECT_NE(client.answer().head.find(std::string("Sec-WebSocket-Protocol: ") + name + "\r\n"),
              std::string::npos);
  }
}

TEST(Foxglove, AdmitsNamedOriginsHereAndNowhereElse) {
  TestServer::Setup setup;
  setup.app.origins = {"https://app.foxglove.dev"};
  TestServer server(setup);
  const std::string token = server.WatchToken();
  const std::string allowed = "Origin: https://app.foxglove.dev\r\n";
  EXPECT_EQ(WebSocket(server.port(), Path(token), "foxglove.sdk.v1", allowed).status(), 101);
  EXPECT_EQ(
      WebSocket(server.port(), Path(token), "foxglove.sdk.v1", "Origin: https://evil.example\r\n")
          .status(),
      403);
  EXPECT_EQ(WebSocket(server.port(), "/ws", "predictor.v1", allowed).status(), 403);
}

Json NextJson(WebSocket* client) {
  for (;;) {
    const auto message = client->Next();
    if (!message || message->opcode == 8) return nullptr;
    if (message->opcode == 1) return Json::parse(message->payload);
  }
}

TEST(Foxglove, AdvertisesAndSendsSubscribedChannels) {
  TestServer server;
  WebSocket client(server.port(), Path(server.WatchToken()), "foxglove.sdk.v1");
  const Json info = NextJson(&client);
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["capabilities"], Json::array());
  const Json advertisement = NextJson(&client);
  EXPECT_EQ(advertisement["op"], "advertise");
  std::map<std::string, Json> channels;
  for (const Json& channel : advertisement["channels"]) {
    EXPECT_EQ(channel["encoding"], "json");
    EXPECT_EQ(channel["schemaEncoding"], "jsonschema");
    EXPECT_EQ(Json::parse(channel["schema"].get<std::string>())["title"], channel["schemaName"]);
    channels[channel["topic"]] = channel;
  }
  for (const char* topic :
       {"/tf", "/scene", "/joint_states", "/run", "/hands/left", "/hands/right", "/cobot",
        "/object", "/movables", "/qp", "/timing", "/wrench_left", "/wrench_right", "/tracking"})
    EXPECT_TRUE(channels.contains(topic)) << topic;
  EXPECT_EQ(channels["/tf"]["schemaName"], "foxglove.FrameTransforms");
  EXPECT_EQ(channels["/scene"]["schemaName"], "foxglove.SceneUpdate");
  EXPECT_EQ(channels["/joint_states"]["schemaName"], "foxglove.JointStates");

  client.SendText(
      Json{{"op", "subscribe"},
           {"subscriptions", {{{"id", 77}, {"channelId", channels["/wrench_left"]["id"]}}}}}
          .dump());
  for (std::uint64_t tick = 1;; ++tick) {
    server.Publish(tick);
    timeval patience{0, 50'000};
    setsockopt(client.socket().descriptor(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    const auto message = client.Next();
    ASSERT_LT(tick, 200u) << "no data came";
    if (!message) continue;
    ASSERT_EQ(message->opcode, 2);
    EXPECT_EQ(message->payload[0], 1);
    std::uint32_t subscription = 0;
    std::memcpy(&subscription, message->payload.data() + 1, 4);
    EXPECT_EQ(subscription, 77u);
    const Json data = Json::parse(message->payload.substr(13));
    EXPECT_EQ(data["force"]["x"], 20.0);
    std::uint64_t time = 0;
    std::memcpy(&time, message->payload.data() + 5, 8);
    EXPECT_EQ(data["timestamp"]["sec"], time / 1'000'000'000);
    break;
  }
}

TEST(Foxglove, CannotControlTheRun) {
  TestServer server;
  const std::string token = server.WatchToken();
  WebSocket client(server.port(), Path(token), "foxglove.sdk.v1");
  NextJson(&client), NextJson(&client);
  for (const char* text :
       {R"({"op":"advertise","channels":[]})", R"({"op":"setParameters","parameters":[]})",
        R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":[5]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})",
        R"({"op":"unsubscribe","subscriptionIds":"x"})"}) {
    client.SendText(text);
    EXPECT_EQ(NextJson(&client)["op"], "status") << text;
  }
  client.SendFrame(2, "\x01garbage");
  EXPECT_EQ(NextJson(&client)["op"], "status");
  client.SendText(R"({"type":"stop"})");
  EXPECT_EQ(client.CloseCode(), 1003);
  EXPECT_EQ(server.mailbox().stops.load(), 0u);
  RunInput input;
  EXPECT_FALSE(server.mailbox().inputs.Pop(&input));
}

// The address may be stored in bookmarks and logs, so the token in it must neither open a page nor
// stop a run.
TEST(Foxglove, ItsTokenDoesNotAdmitPages) {
  TestServer server;
  const std::string token = server.WatchToken();
  WebSocket page(server.port());
  page.SendText("{\"type\":\"hello\",\"token\":\"" + token + "\"}");
  page.SendText(R"({"type":"stop"})");
  EXPECT_FALSE(page.NextText("welcome"));
  EXPECT_EQ(server.mailbox().stops.load(), 0u);
  EXPECT_FALSE(server.Do([&](ViewerApp& app) { return app.admission().ByToken(token); }));
}

TEST(Foxglove, TheConsoleDisconnectsItPermanently) {
  TestServer server;
  const std::string token = server.WatchToken();
  WebSocket one(server.port(), Path(token), "foxglove.sdk.v1");
  WebSocket other(server.port(), Path(token), "foxglove.sdk.v1");
  NextJson(&one), NextJson(&one), NextJson(&other), NextJson(&other);
  const std::string unused = server.WatchToken();
  EXPECT_EQ(server.Do([](ViewerApp& app) { return app.foxglove().Kick(); }), 2u);
  server.Do([](ViewerApp& app) { return app.admission().Renew({0, 1}), 0; });
  EXPECT_EQ(one.CloseCode(), 1008);
  EXPECT_EQ(other.CloseCode(), 1008);
  for (const std::string& ended : {token, unused})
    EXPECT_EQ(WebSocket(server.port(), Path(ended), "foxglove.sdk.v1").status(), 401);
  EXPECT_EQ(WebSocket(server.port(), Path(server.WatchToken()), "foxglove.sdk.v1").status(), 101);
}

TEST(Foxglove, IsNotifiedThatTheRunHasEnded) {
  TestServer server;
  WebSocket client(server.port(), Path(server.WatchToken()), "foxglove.sdk.v1");
  NextJson(&client), NextJson(&client);
  server.Do([](ViewerApp& app) { return app.EndRun("The run is finished.", false), 0; });
  EXPECT_EQ(NextJson(&client)["message"], "The run is finished.");
  EXPECT_EQ(client.CloseCode(), 1001);
}

// Checks that the types and names in a message conform to the message's own schema.
void ExpectFits(const Json& schema, const Json& value, const std::string& path) {
  if (schema.contains("oneOf")) {
    const auto& choices = schema["oneOf"];
    EXPECT_TRUE(std::any_of(choices.begin(), choices.end(), [&](const Json& choice) {
      return choice["const"] == value;
    })) << path;
    return;
  }
  const std::string type = schema["type"];
  if (type == "object") {
    ASSERT_TRUE(value.is_object()) << path;
    for (const Json& name : schema.value("required", Json::array()))
      EXPECT_TRUE(value.contains(name)) << path << name;
    for (const auto& [name, member] : value.items()) {
      ASSERT_TRUE(schema["properties"].contains(name)) << path << "." << name;
      ExpectFits(schema["properties"][name], member, path + "." + name);
    }
  } else if (type == "array") {
    ASSERT_TRUE(value.is_array()) << path;
    for (const Json& item : value) ExpectFits(schema["items"], item, path + "[]");
  } else if (type == "integer") {
    EXPECT_TRUE(value.is_number_integer()) << path;
  } else if (type == "number") {
    EXPECT_TRUE(value.is_number()) << path;
  } else if (type == "string") {
    EXPECT_TRUE(value.is_string()) << path;
  } else if (type == "boolean") {
    EXPECT_TRUE(value.is_boolean()) << path;
  } else {
    ADD_FAILURE() << path << " has the type " << type;
  }
}

TEST(Foxglove, MessagesFitTheirSchemas) {
  TickRecord record = {};
  record.parameters = {1, 1, 1, 30, 5};
  record.link_distance = std::numeric_limits<double>::infinity();
  for (HandRecord& hand : record.hands) {
    hand.present = 1;
    hand.real.pose.q[0] = hand.virtual_.pose.q[0] = 1;
    hand.wrench = {10, 0, 20, 0, 1, 0};
  }
  for (const char* name : {"box_9kg.yaml", "bar_circle.yaml", "dual_ur5.yaml"}) {
    const Scenario scenario =
        LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name);
    for (const FoxgloveChannel& channel : FoxgloveChannels(scenario, {0.5, 0, 0.3}))
      ExpectFits(channel.schema, channel.message(record, 1), channel.topic);
  }
}

// The cobot's figure and its links must agree with the recorded pose of the end-effector, for any
// base.
TEST(Foxglove, ShowsTheCobotWhereItIs) {
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml",
                   {"cobot.base.xyz=[0.1, -0.2, 0.3]", "cobot.base.rpy=[0, 0, 0.5]"});
  const auto robot = RobotModel::Load({scenario.cobot.model, scenario.file.parent_path(),
                                       scenario.cobot.remove_links, scenario.cobot.base.ToPose()});
  const FrameId end = robot->Frame(scenario.cobot.end_effector);
  RobotData data(*robot);
  JointVector q(robot->dof());
  TickRecord record = {};
  for (int j = 0; j < robot->dof(); ++j)
    record.cobot_q[static_cast<std::size_t>(j)] = q[j] = 0.3 * j - 0.5;
  data.UpdateKinematics(*robot, q, JointVector::Zero(robot->dof()));
  const Vector3 p = data.FramePose(*robot, end).p;
  const auto near = [](const Json& xyz, const Vector3& to) {
    return (Vector3(xyz["x"].get<double>(), xyz["y"].get<double>(), xyz["z"].get<double>()) - to)
               .norm() < 1e-12;
  };

  const auto channels = FoxgloveChannels(scenario, {0.5, 0, 0.3});
  int found = 0;
  const Json tf = channels[0].message(record, 1);
  for (const Json& transform : tf["transforms"])
    if (transform["child_frame_id"] == "cobot/" + scenario.cobot.end_effector)
      found += near(transform["translation"], p);
  EXPECT_EQ(found, 1);
  const Json scene = channels[1].message(record, 1);
  for (const Json& entity : scene["entities"]) {
    if (entity["id"] != "cobot") continue;
    ASSERT_EQ(entity["spheres"].size(), static_cast<std::size_t>(robot->dof()) + 2);
    EXPECT_TRUE(near(entity["spheres"].front()["pose"]["position"], {0.1, -0.2, 0.3}));
    EXPECT_TRUE(near(entity["spheres"].back()["pose"]["position"], p));
    ++found;
  }
  EXPECT_EQ(found, 2);
}

TEST(Foxglove, ShowsTheFixtures) {
  Scenario scenario = LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
  scenario.environment.fixtures.resize(2);
  scenario.environment.fixtures[0].xyz = {1, 2, 3};
  scenario.environment.fixtures[1].shape = FixtureShape::kCapsule;
  const auto channels = FoxgloveChannels(scenario, {0.5, 0, 0.3});
  const Json scene = channels[1].message(TickRecord{}, 1);
  int found = 0;
  for (const Json& entity : scene["entities"]) {
    if (entity["id"] != "fixtures") continue;
    ++found;
    ASSERT_EQ(entity["cubes"].size(), 1u);
    EXPECT_EQ(entity["cubes"][0]["pose"]["position"]["z"], 3.0);
    EXPECT_EQ(entity["cylinders"].size(), 1u);
    EXPECT_EQ(entity["spheres"].size(), 2u);
  }
  EXPECT_EQ(found, 1);
}

// The colours are green, orange and red, as in the page, relative to the current threshold.
TEST(Foxglove, ArrowsWarn) {
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
  const auto channels = FoxgloveChannels(scenario, {0.5, 0, 0.3});
  const auto arrow = [&](double force, double threshold) {
    TickRecord record = {};
    record.parameters = {1, 1, 1, threshold, 5};
    record.hands[0].present = 1;
    record.hands[0].virtual_.pose.q[0] = record.hands[0].real.pose.q[0] = 1;
    record.hands[0].wrench[2] = force;
    const Json scene = channels[1].message(record, 1);
    for (const Json& entity : scene["entities"])
      if (entity["id"] == "left_hand") return entity["arrows"][0];
    return Json();
  };
  const auto red = [&](double force, double threshold) {
    return arrow(force, threshold)["color"]["r"].get<double>();
  };
  EXPECT_LT(red(14, 30), 0.3);
  EXPECT_GT(red(16, 30), 0.9);
  EXPECT_NEAR(red(25, 30), 0.85, 1e-9);
  EXPECT_NEAR(red(14, 15), 0.85, 1e-9);
  const Json a = arrow(20, 30);
  EXPECT_NEAR(a["shaft_length"].get<double>() + a["head_length"].get<double>(), 0.2, 1e-9);
  // The arrow points along +z, so the rotation maps x to z.
  const Json q = a["pose"]["orientation"];
  EXPECT_NEAR(q["y"].get<double>(), -std::sqrt(0.5), 1e-9);
}

}  // namespace
}  // namespace predictor::viewer
