// The ROS messages that this server sends, as plain structs, and the encoding of these messages.
// The field names match the message definitions of common_msgs (ROS 1 Noetic and ROS 2 Humble).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/types.h"
#include "ros_tcp/ros_writer.h"

namespace predictor::ros_tcp {

struct RosHeader {
  std::uint32_t seq = 0;  // ROS 1 only
  std::uint32_t sec = 0, nanosec = 0;
  std::string frame_id = "world";
};

struct RosString {
  static constexpr const char* kType = "std_msgs/String";
  std::string data;
};

struct RosJointState {
  static constexpr const char* kType = "sensor_msgs/JointState";
  RosHeader header;
  std::vector<std::string> name;
  std::vector<double> position, velocity, effort;  // [rad], [rad/s], [N·m]
};

struct RosPoseStamped {
  static constexpr const char* kType = "geometry_msgs/PoseStamped";
  RosHeader header;
  Pose pose;
};

struct RosWrenchStamped {
  static constexpr const char* kType = "geometry_msgs/WrenchStamped";
  RosHeader header;
  Wrench wrench = Wrench::Zero();  // force [N], torque [N·m]
};

struct RosFloat64MultiArray {
  static constexpr const char* kType = "std_msgs/Float64MultiArray";
  std::string label;  // label of the only dimension
  std::vector<double> data;
};

struct RosMarker {
  static constexpr const char* kType = "visualization_msgs/Marker";
  enum : std::int32_t { kArrow = 0, kLineStrip = 4, kText = 9 };
  enum : std::int32_t { kAdd = 0, kDelete = 2 };
  RosHeader header;
  std::string ns;
  std::int32_t id = 0, type = kArrow, action = kAdd;
  Pose pose;
  Vector3 scale = Vector3::Zero();            // [m]
  std::array<float, 4> color = {0, 0, 0, 1};  // r g b a
  std::vector<Vector3> points;                // [m]
  std::string text;
};

std::string Serialise(const RosString& message, RosDialect dialect);
std::string Serialise(const RosJointState& message, RosDialect dialect);
std::string Serialise(const RosPoseStamped& message, RosDialect dialect);
std::string Serialise(const RosWrenchStamped& message, RosDialect dialect);
std::string Serialise(const RosFloat64MultiArray& message, RosDialect dialect);
std::string Serialise(const RosMarker& message, RosDialect dialect);

}  // namespace predictor::ros_tcp
