// A run as Foxglove and its forks show it: topics in JSON, for its live protocol and for
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

// A topic: how it is advertised, and how a record becomes a message of it.
struct FoxgloveChannel {
  std::string topic, schema_name;
  Json schema;
  std::function<Json(const TickRecord& record, std::uint64_t unix_ns)> message;
};

// All of them; object_start: O in W at the start [m]. Throws InputError.
std::vector<FoxgloveChannel> FoxgloveChannels(const Scenario& scenario,
                                              const Vector3& object_start);

// What shows where things are: "/tf" and "/scene". As above.
std::vector<FoxgloveChannel> FoxgloveSceneChannels(const Scenario& scenario,
                                                   const Vector3& object_start);

}  // namespace predictor
