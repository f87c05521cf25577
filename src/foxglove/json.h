// Makes the values and schemas of the channels for Foxglove. Only this folder uses this file.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "core/types.h"
#include "foxglove/channels.h"

namespace predictor::foxglove {

// ---- values ------------------------------------------------------------------------------------

Json Time(std::uint64_t ns);
Json Xyz(const Vector3& v);
Json Xyz(const double* v);
Json PoseJson(const Pose& X);
Json Color(double r, double g, double b, double a);

// ---- schemas (JSON Schema, draft 7)
// --------------------------------------------------------------

using Fields = std::initializer_list<std::pair<const char*, Json>>;

Json Number();
Json Integer();
Json Text();
Json ListOf(const Json& items);
// Returns an unnamed object whose fields are all required.
Json Object(Fields fields);
Json Numbers(std::initializer_list<const char*> names);
// Returns a message named `title`. All fields are required except those in `optional`.
Json Message(const char* title, Fields fields, std::initializer_list<const char*> optional = {});
Json TimeSchema();
Json XyzSchema();

// The schemas of Foxglove's well-known messages, including fields that this program never sets.
Json FrameTransformsSchema();
Json SceneUpdateSchema();
Json JointStatesSchema();

// ---- channels
// ------------------------------------------------------------------------------------

// Returns a channel for each group of recorded quantities (core/tick_fields.h) except the inputs.
std::vector<FoxgloveChannel> QuantityChannels();
FoxgloveChannel TransformsChannel(const Scenario& scenario);
// `object_start` is the position of O in W at the start [m].
FoxgloveChannel SceneChannel(const Scenario& scenario, const Vector3& object_start);

}  // namespace predictor::foxglove
