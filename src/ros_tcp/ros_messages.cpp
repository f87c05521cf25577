#include "ros_tcp/ros_messages.h"

namespace predictor::ros_tcp {
namespace {

void Write(const RosHeader& h, RosWriter* w) {
  if (w->dialect() == RosDialect::kRos1) w->Number(h.seq);
  w->Number(h.sec);
  w->Number(h.nanosec);
  w->String(h.frame_id);
}

void Write(const Vector3& v, RosWriter* w) {
  for (int i = 0; i < 3; ++i) w->Number<double>(v[i]);
}

void Write(const Pose& X, RosWriter* w) {
  Write(X.p, w);
  for (const double q : {X.q.x(), X.q.y(), X.q.z(), X.q.w()}) w->Number(q);
}

void Write(const std::vector<double>& values, RosWriter* w) {
  w->Count(values.size());
  for (const double value : values) w->Number(value);
}

}  // namespace

const char* Name(RosDialect dialect) { return dialect == RosDialect::kRos1 ? "ROS1" : "ROS2"; }

std::string Serialise(const RosString& message, RosDialect dialect) {
  RosWriter w(dialect);
  w.String(message.data);
  return w.Take();
}

std::string Serialise(const RosJointState& message, RosDialect dialect) {
  RosWriter w(dialect);
  Write(message.header, &w);
  w.Count(message.name.size());
  for (const std::string& name : message.name) w.String(name);
  Write(message.position, &w);
  Write(message.velocity, &w);
  Write(message.effort, &w);
  return w.Take();
}

std::string Serialise(const RosPoseStamped& message, RosDialect dialect) {
  RosWriter w(dialect);
  Write(message.header, &w);
  Write(message.pose, &w);
  return w.Take();
}

std::string Serialise(const RosWrenchStamped& message, RosDialect dialect) {
  RosWriter w(dialect);
  Write(message.header, &w);
  Write(Vector3(message.wrench.head<3>()), &w);
  Write(Vector3(message.wrench.tail<3>()), &w);
  return w.Take();
}

std::string Serialise(const RosFloat64MultiArray& message, RosDialect dialect) {
  RosWriter w(dialect);
  const auto size = static_cast<std::uint32_t>(message.data.size());
  w.Count(1);  // dimensions
  w.String(message.label);
  w.Number(size);
  w.Number(size);              // stride
  w.Number<std::uint32_t>(0);  // data offset
  Write(message.data, &w);
  return w.Take();
}

std::string Serialise(const RosMarker& message, RosDialect dialect) {
  RosWriter w(dialect);
  Write(message.header, &w);
  w.String(message.ns);
  w.Number(message.id);
  w.Number(message.type);
  w.Number(message.action);
  Write(message.pose, &w);
  Write(message.scale, &w);
  for (const float c : message.color) w.Number(c);
  w.Number<std::int32_t>(0);  // lifetime: unlimited
  w.Number<std::int32_t>(0);
  w.Bool(false);  // frame_locked
  w.Count(message.points.size());
  for (const Vector3& p : message.points) Write(p, &w);
  w.Count(0);  // colors: none, one color for all points
  if (dialect == RosDialect::kRos2) {
    w.String("");  // texture_resource
    RosHeader none;
    none.frame_id.clear();
    Write(none, &w);  // texture: header,
    w.String("");     // format,
    w.Count(0);       // data
    w.Count(0);       // uv_coordinates
  }
  w.String(message.text);
  w.String("");  // mesh_resource
  if (dialect == RosDialect::kRos2) {
    w.String("");  // mesh_file: name,
    w.Count(0);    // data
  }
  w.Bool(false);  // mesh_use_embedded_materials
  return w.Take();
}

}  // namespace predictor::ros_tcp
