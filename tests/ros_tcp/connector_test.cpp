// Runs a client that behaves like ROS-TCP-Connector 0.7.0 for a minute, or for an hour in ./dev
// soak.
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "ros_tcp/unity.h"
#include "support/soak.h"

namespace predictor::ros_tcp {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr auto kSilence = milliseconds(1000);  // after this, the client sends a keep-alive
constexpr auto kChange = milliseconds(2000);   // between changes of the subscriptions
// The longest gap between messages is so large that the speed of the machine does not matter.
constexpr auto kLongestGap = milliseconds(10'000);

// Imitates the Connector's two threads and its Update(). The client uses a single connection for
// all messages, and the greeting comes first. An empty frame follows at the start and after each
// second of silence. In ROS 2 mode, each destination and each JSON text ends with a NUL.
class Connector {
 public:
  Connector(std::uint16_t port, RosDialect dialect) : socket_(port), dialect_(dialect) {
    const RosFrame greeting = socket_.Receive();
    EXPECT_EQ(greeting.destination, "__handshake");
    const std::string version = Json::parse(greeting.payload)["version"];
    EXPECT_TRUE(version.starts_with("v0.7."));
    KeepAlive();
    Command("__topic_list", Json::object());
    Command("__publish", {{"topic", "/predictor/stop"},
                          {"message_name", "std_msgs/Bool"},
                          {"queue_size", 10},
                          {"latch", false}});
  }

  void Command(const std::string& name, const Json& json) {
    const std::string end = dialect_ == RosDialect::kRos2 ? std::string(1, '\0') : "";
    Write(Encode(name + end, json.dump() + end));
  }
  void Publish(const std::string& topic, const std::string& message) {
    const std::string end = dialect_ == RosDialect::kRos2 ? std::string(1, '\0') : "";
    Write(Encode(topic + end, message));
  }
  void KeepAliveIfSilent() {
    if (Clock::now() - spoke_ >= kSilence) KeepAlive();
  }
  RosFrame Receive() { return socket_.Receive(); }
  int keep_alives() const { return keep_alives_; }

 private:
  void KeepAlive() {
    Write(std::string(8, '\0'));
    ++keep_alives_;
  }
  void Write(const std::string& bytes) {
    socket_.Raw(bytes);
    spoke_ = Clock::now();
  }

  Unity socket_;
  RosDialect dialect_;
  Clock::time_point spoke_;
  int keep_alives_ = 0;
};

class ConnectorTest : public RosTcp {
 protected:
  // Sends the next request of a scene that its user edits while the scene plays.
  void Change(Connector* unity) {
    const auto& list = topics_->list();
    const RosTopic& topic = list[changes_ % list.size()];
    const Json what = {{"topic", topic.name}, {"message_name", topic.type}};
    if (subscribed_.insert(topic.name).second) {
      unity->Command("__subscribe", what);
    } else {
      subscribed_.erase(topic.name);
      unity->Command("__remove_subscriber", what);
    }
    unity->Command("__topic_list", Json::object());
    ++lists_asked_;
    for (const char* command :
         {"__remove_publisher", "__remove_ros_service", "__remove_unity_service"})
      if (changes_ % 3 == 1) unity->Command(command, {{"topic", "/not_ours"}});
    const std::string header = GetParam() == RosDialect::kRos2 ? std::string("\0\1\0\0", 4) : "";
    unity->Publish("/predictor/stop", header + std::string(1, '\0'));  // false requests no stop
    ++changes_;
  }

  void Take(const RosFrame& frame) {
    ASSERT_FALSE(frame.destination.empty()) << "the server closed the connection";
    if (frame.destination == "__topic_list") {
      ++lists_;
      EXPECT_EQ(Json::parse(frame.payload)["topics"].size(),
                topics_->list().size() + 1);  // the stop
    } else if (frame.destination == "__error" || frame.destination == "__warn") {
      ADD_FAILURE() << frame.payload;
    } else {
      ++messages_[frame.destination];
    }
  }

  std::set<std::string> subscribed_;
  std::size_t changes_ = 0;
  int lists_asked_ = 1, lists_ = 0;
  std::map<std::string, long> messages_;
};
INSTANTIATE_TEST_SUITE_P(Dialects, ConnectorTest,
                         testing::Values(RosDialect::kRos1, RosDialect::kRos2),
                         [](const auto& dialect) { return Name(dialect.param); });

TEST_P(ConnectorTest, SurvivesItsTrafficSoak) {
  const auto traffic = std::chrono::seconds(Count(20, 3600));
  Connector unity(server_->port(), GetParam());
  unity.Command("__subscribe",
                {{"topic", "/predictor/state"}, {"message_name", "std_msgs/String"}});
  subscribed_.insert("/predictor/state");
  const auto start = Clock::now();
  auto changed = start, heard = start;
  while (Clock::now() - start < traffic) {
    // Receives everything that the server sends between two changes of the scene, while the client
    // is silent.
    while (Clock::now() - changed < kChange) {
      const RosFrame frame = unity.Receive();
      ASSERT_LT(Clock::now() - heard, kLongestGap);
      heard = Clock::now();
      ASSERT_NO_FATAL_FAILURE(Take(frame));
      unity.KeepAliveIfSilent();
    }
    changed = Clock::now();
    Change(&unity);
    // The loop above waits for the state's topic, so the client always subscribes to it again.
    if (subscribed_.insert("/predictor/state").second)
      unity.Command("__subscribe",
                    {{"topic", "/predictor/state"}, {"message_name", "std_msgs/String"}});
  }
  while (lists_ < lists_asked_) ASSERT_NO_FATAL_FAILURE(Take(unity.Receive()));
  EXPECT_EQ(mailbox_->stops.load(), 0u);
  EXPECT_GT(unity.keep_alives(), 1);
  EXPECT_GE(messages_.size(), std::min(changes_, topics_->list().size()));
  long all = 0;
  for (const auto& [topic, count] : messages_) all += count;
  std::printf("%ld messages of %zu topics in %lld s, %d keep-alives, %zu changes.\n", all,
              messages_.size(), static_cast<long long>(traffic.count()), unity.keep_alives(),
              changes_);
}

}  // namespace
}  // namespace predictor::ros_tcp
