#include "recording/scene.h"

#include "core/person_json.h"
#include "foxglove/channels.h"

namespace predictor {

std::vector<JsonChannel> RecordedScene(const Scenario& scenario, const Vector3& object_start) {
  std::vector<JsonChannel> channels;
  for (const FoxgloveChannel& channel : FoxgloveSceneChannels(scenario, object_start))
    channels.push_back({channel.topic, channel.schema_name, channel.schema.dump(),
                        [message = channel.message](const TickRecord& record, std::uint64_t ns) {
                          return message(record, ns).dump();
                        }});
  return channels;
}

JsonChannel PersonChannel() { return {kPersonTopic, "predictor.PersonState", PersonSchema(), {}}; }

}  // namespace predictor
