// Definitions of the messages in the format of ROS 2, derived from core/tick_fields.h.
#pragma once

#include <string>

#include "core/tick_fields.h"

namespace predictor::recording {

// Returns the definition of a group's message and of the types that it uses.
const std::string& Definition(TickGroup group);

inline constexpr const char* kSnapshotTopic = "/snapshot";
inline constexpr const char* kSnapshotType = "predictor_msgs/msg/Snapshot";
inline constexpr const char* kSnapshotDefinition =
    "uint64 tick  # after which the state was so\nuint8[] data  # of this build of the program\n";

inline constexpr const char* kEventsTopic = "/events";
// The events have Foxglove's type, so that Foxglove's log panel shows them. The fields for the tick
// and the number of lost ticks are added to Foxglove's type.
inline constexpr const char* kEventType = "foxglove.Log";
const std::string& EventSchema();  // JSON Schema

// Reduces a definition to the content that determines the bytes, without comments, constants and
// empty lines.
std::string Layout(const std::string& definition);

}  // namespace predictor::recording
