// Publishes a run as JSON topics for Foxglove and its forks, for the live protocol and for
// recordings.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

using Json = nlohmann::ordered_json;

// A topic: its description for clients, and the conversion of a record to a message.
struct FoxgloveChannel {
  std::string topic, schema_name;
  Json schema;
  std::function<Json(const TickRecord& record, std::uint64_t unix_ns)> message;
};

// Returns all topics. `object_start` is the position of O in W at the start [m]. Throws InputError.
std::vector<FoxgloveChannel> FoxgloveChannels(const Scenario& scenario,
                                              const Vector3& object_start);

// Returns the topics that show poses and shapes, "/tf" and "/scene". The parameters are the same as
// for FoxgloveChannels.
std::vector<FoxgloveChannel> FoxgloveSceneChannels(const Scenario& scenario,
                                                   const Vector3& object_start);

}  // namespace predictor
