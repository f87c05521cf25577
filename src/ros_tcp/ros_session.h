// Keeps the protocol state of one ROS-TCP client, interprets its messages and answers them. It uses
// no sockets.
#pragma once

#include <functional>
#include <set>
#include <string>

#include "ros_tcp/framing.h"
#include "ros_tcp/ros_writer.h"
#include "ros_tcp/topics.h"

namespace predictor::ros_tcp {

class RosSession {
 public:
  // The session calls on_stop when a client requests a stop. `topics` is borrowed.
  RosSession(const RosTopics* topics, RosDialect dialect, std::function<void()> on_stop);

  // Returns the first frame that the server sends.
  std::string Greeting() const;
  // Returns the encoded answers to a frame, or "" if the frame needs no answer.
  std::string OnFrame(const RosFrame& frame);
  // Returns the encoded frames of the publications to which this client has subscribed.
  std::string Select(const std::vector<RosPublication>& publications) const;
  // Returns whether the client has not subscribed to a topic and has not announced or sent a stop.
  bool idle() const { return subscribed_.empty() && !may_stop_; }

 private:
  std::string OnCommand(const RosFrame& frame);
  std::string Subscribe(const std::string& topic, const std::string& type);
  std::string OnMessage(const RosFrame& frame);

  const RosTopics* topics_;
  RosDialect dialect_;
  std::function<void()> on_stop_;
  std::set<std::size_t> subscribed_;
  bool may_stop_ = false;
};

}  // namespace predictor::ros_tcp
