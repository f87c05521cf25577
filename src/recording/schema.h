// The messages' definitions as ROS 2 writes them, out of the same walks that encode.
#pragma once

#include <string>

#include "recording/fields.h"

namespace predictor::recording {

// Definition of a group's message, with those of the types that it uses.
const std::string& Definition(Group group);

inline constexpr const char* kSnapshotTopic = "/snapshot";
inline constexpr const char* kSnapshotType = "predictor_msgs/msg/Snapshot";
inline constexpr const char* kSnapshotDefinition =
    "uint64 tick  # after which the state was so\nuint8[] data  # of this build of the program\n";

inline constexpr const char* kEventsTopic = "/events";
// Foxglove's, so that its log shows them, with the tick and how many were lost.
inline constexpr const char* kEventType = "foxglove.Log";
const std::string& EventSchema();  // JSON Schema

// A definition without what does not concern the bytes: comments, constants, empty lines.
std::string Layout(const std::string& definition);

}  // namespace predictor::recording
