#include "ros_tcp/ros_session.h"

#include <nlohmann/json.hpp>

namespace predictor::ros_tcp {
namespace {

using Json = nlohmann::ordered_json;

// The text may come from a client and need not be valid UTF-8.
std::string Command(const char* name, const Json& json) {
  return Encode(name, json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string Say(const char* level, const std::string& text) {
  return Command(level, {{"text", text}});
}

// Returns a string member of a command's JSON, or "" if the member is missing or not a string.
std::string Text(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

RosSession::RosSession(const RosTopics* topics, RosDialect dialect, std::function<void()> on_stop)
    : topics_(topics), dialect_(dialect), on_stop_(std::move(on_stop)) {}

std::string RosSession::Greeting() const {
  const Json metadata = {{"protocol", Name(dialect_)}};
  return Command("__handshake", {{"version", "v0.7.0"}, {"metadata", metadata.dump()}});
}

std::string RosSession::OnFrame(const RosFrame& frame) {
  return frame.destination.rfind("__", 0) == 0 ? OnCommand(frame) : OnMessage(frame);
}

std::string RosSession::OnCommand(const RosFrame& frame) {
  const Json json = Json::parse(frame.payload.empty() ? "{}" : frame.payload, nullptr, false);
  if (!json.is_object())
    return Say("__error", frame.destination.substr(0, 40) + ": its payload is not a JSON object.");
  const std::string topic = Text(json, "topic");
  const std::string& name = frame.destination;
  if (name == "__topic_list") {
    Json names = Json::array(), types = Json::array();
    for (const RosTopic& t : topics_->list()) names.push_back(t.name), types.push_back(t.type);
    names.push_back(RosTopics::kStop), types.push_back(RosTopics::kStopType);
    return Command("__topic_list", {{"topics", names}, {"types", types}});
  }
  if (name == "__subscribe") return Subscribe(topic, Text(json, "message_name"));
  if (name == "__publish") {
    may_stop_ = may_stop_ || topic == RosTopics::kStop;
    if (topic == RosTopics::kStop) return "";
    return Say("__warn", "This server does not read " + topic.substr(0, 100) + "; it reads only " +
                             RosTopics::kStop + ".");
  }
  if (name == "__remove_subscriber") {
    std::erase_if(subscribed_, [&](std::size_t i) { return topics_->list()[i].name == topic; });
    return "";
  }
  if (name == "__remove_publisher" && topic == RosTopics::kStop) may_stop_ = false;
  if (name == "__remove_publisher" || name == "__remove_ros_service" ||
      name == "__remove_unity_service" || name == "__unity_service")
    return "";
  // The destination of the next frame is the name of a service, which this server ignores.
  if (name == "__request") return Say("__error", "This server has no services.");
  if (name == "__response") return "";
  if (name == "__ros_service")
    return Say("__error", "There is no service " + topic.substr(0, 100) + ".");
  return Say("__error", "Unknown command " + name.substr(0, 40) + ".");
}

std::string RosSession::Subscribe(const std::string& topic, const std::string& type) {
  for (std::size_t i = 0; i < topics_->list().size(); ++i) {
    const RosTopic& t = topics_->list()[i];
    if (t.name != topic) continue;
    if (!type.empty() && type != t.type)
      return Say("__error", topic + " is of type " + t.type + ", not " + type.substr(0, 60) + ".");
    subscribed_.insert(i);
    return "";
  }
  return Say("__warn", "There is no topic " + topic.substr(0, 100) + ". Request the topic list.");
}

// The message is a std_msgs/Bool, which is one byte. In ROS 2, a header of four bytes precedes this
// byte.
std::string RosSession::OnMessage(const RosFrame& frame) {
  if (frame.destination != RosTopics::kStop) return "";
  const std::size_t header = dialect_ == RosDialect::kRos2 ? 4 : 0;
  if (frame.payload.size() < header + 1)
    return Say("__error", std::string(RosTopics::kStop) + " needs a " + RosTopics::kStopType + ".");
  may_stop_ = true;
  if (frame.payload[header] != 0) on_stop_();
  return "";
}

std::string RosSession::Select(const std::vector<RosPublication>& publications) const {
  std::string out;
  for (const RosPublication& p : publications)
    if (subscribed_.contains(p.topic)) out += Encode(topics_->list()[p.topic].name, p.payload);
  return out;
}

}  // namespace predictor::ros_tcp
