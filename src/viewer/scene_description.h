// The description of the scene for the page (docs/reference/viewer-protocol.md, "The scene").
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "core/record.h"
#include "scenario/scenario.h"
#include "viewer/asset_store.h"

namespace predictor::viewer {

// Describes the fixtures that are present while `events` act (one bit for each entry of the
// scenario's `events`). The description does not reveal that a fixture will appear or disappear.
nlohmann::ordered_json DescribeFixtures(const Scenario& scenario, std::uint16_t events);

// Returns what each acting event does, as sentences without a full stop. The event that began last
// is the last one. `events` is as above, and `latest_event` is 1 + the number of the hazard that
// began last, or 0 (TickRecord::latest_event). The events that do not act are not described,
// because the pages of subjects also receive this list.
nlohmann::ordered_json DescribeActing(const Scenario& scenario, std::uint16_t events,
                                      std::uint8_t latest_event);

// Reads the scenario's models into `assets` and describes the scene before any event.
// `object_start` is the position of the object's frame O in W at the start of the run [m]. Throws
// InputError.
nlohmann::ordered_json DescribeScene(const Scenario& scenario, const Vector3& object_start,
                                     AssetStore* assets);

// Returns a sentence about the thresholds that a reset kept tighter than those of the scenario, or
// "" if there are no such thresholds. `record` is a record after the reset.
std::string KeptThresholds(const Scenario& scenario, const TickRecord& record);

}  // namespace predictor::viewer
