// Builds the record of a tick from its values and the supervisor's decisions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/record.h"
#include "emulator/supervisor.h"
#include "emulator/tick_data.h"
#include "scenario/action_time.h"
#include "scenario/scenario.h"

namespace predictor {

struct RecordSources {
  const Scenario& scenario;
  const TickPlan& plan;
  const TickData& data;
  const Supervisor& supervisor;
  const std::vector<ActionSpan>& script;  // script of the operator
  bool simulated_operator = false;  // true if data.person is a simulated operator; otherwise a
                                    // person holds the handles
};

// Writes the whole record except the times of the stages. Increments record->tick.
void BuildRecord(const RecordSources& from, std::uint64_t wall_ns, TickRecord* record) noexcept;

}  // namespace predictor
