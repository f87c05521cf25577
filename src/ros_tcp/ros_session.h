// What one ROS-TCP client says and is told. No sockets.
#pragma once

#include <functional>
#include <set>
#include <string>

#include "ros_tcp/framing.h"
#include "ros_tcp/ros_writer.h"
#include "ros_tcp/topics.h"

namespace predictor {

class RosSession {
 public:
  static constexpr std::size_t kMostTopics = 64;  // that a client may subscribe or announce

  // on_stop: a client asked for the stop. `topics` is borrowed.
  RosSession(const RosTopics* topics, RosDialect dialect, std::function<void()> on_stop);

  // The frame that must come first.
  std::string Greeting() const;
  // Answers to a frame, to be sent; empty if there are none.
  std::string OnFrame(const RosFrame& frame);
  // The frames of those publications that this client subscribed to.
  std::string Select(const std::vector<RosPublication>& publications) const;

 private:
  std::string OnCommand(const RosFrame& frame);
  std::string Subscribe(const std::string& topic, const std::string& type);
  std::string OnMessage(const RosFrame& frame);

  const RosTopics* topics_;
  RosDialect dialect_;
  std::function<void()> on_stop_;
  std::set<std::size_t> subscribed_;
};

}  // namespace predictor
