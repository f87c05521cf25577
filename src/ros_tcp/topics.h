// The topics that are published over ROS-TCP, and their messages, computed from a record.
#pragma once

#include <string>
#include <vector>

#include "core/record.h"
#include "ros_tcp/ros_messages.h"
#include "scenario/scenario.h"

namespace predictor::ros_tcp {

struct RosTopic {
  std::string name, type;
};

// One message that is ready to be sent.
struct RosPublication {
  std::size_t topic;  // index into RosTopics::list()
  std::string payload;
};

// Topics begin with /predictor/:
//   joint_states                     the virtual cobot
//   object/pose, SIDE_handle/pose    virtual; SIDE_handle/real_pose: the real handle
//   SIDE_handle/wrench               of the hand on the handle, axes of W
//   markers                          arrows of the forces, the guidance path
//   state                            "RUN", or "HELD force left 30.1 30" after a stop
//   tracking                         [left, right] distances of real and virtual handles [m]
class RosTopics {
 public:
  // `joints` are the names of the cobot's joints. `object_start` is the start of the guidance path,
  // in W [m].
  RosTopics(const Scenario& scenario, std::vector<std::string> joints, const Vector3& object_start);

  const std::vector<RosTopic>& list() const { return list_; }
  // Returns all messages of this record. `sec` and `nanosec` are the time of this record on the
  // system's clock.
  std::vector<RosPublication> Publish(const TickRecord& record, RosDialect dialect,
                                      std::uint32_t sec, std::uint32_t nanosec) const;

  static constexpr const char* kStop = "/predictor/stop";  // std_msgs/Bool: true stops the run
  static constexpr const char* kStopType = "std_msgs/Bool";

 private:
  std::size_t Index(const std::string& name) const;
  RosMarker Arrow(const TickRecord& record, std::size_t hand, bool torque) const;
  RosMarker Guidance() const;

  std::vector<std::string> joints_;
  GuidanceSpec guidance_;
  Vector3 object_start_;
  std::vector<RosTopic> list_;
};

// Returns green if `share` of the threshold is below 0.5, orange up to 0.8, and red above 0.8.
std::array<float, 4> WarningColor(double share);

}  // namespace predictor::ros_tcp
