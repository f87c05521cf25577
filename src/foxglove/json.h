// What Foxglove's channels are made of: values and schemas. Used in this folder alone.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>

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
// An object that must have all of its fields, and no name.
Json Object(Fields fields);
Json Numbers(std::initializer_list<const char*> names);
// A message of that name; of its fields those in `optional` may be left out.
Json Message(const char* title, Fields fields, std::initializer_list<const char*> optional = {});
Json TimeSchema();
Json XyzSchema();

// Foxglove's well-known messages, whole: also what is never filled in here.
Json FrameTransformsSchema();
Json SceneUpdateSchema();
Json JointStatesSchema();

// ---- channels
// ------------------------------------------------------------------------------------

FoxgloveChannel TransformsChannel(const Scenario& scenario);
// object_start: O in W at the start [m].
FoxgloveChannel SceneChannel(const Scenario& scenario, const Vector3& object_start);

}  // namespace predictor::foxglove
