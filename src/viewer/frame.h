// The binary format in which pages receive the record of a tick. This format is packed and
// little-endian, and a list of fields describes it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor::viewer {

// The way in which the page interprets the numbers of a field.
enum class FrameKind : std::uint8_t {
  kNumber,
  kNumbers,
  kFlag,
  kPose,
  kPoses,
  kState,
  kCause,
  kQuantity
};

// An entry of `welcome.frame`: `count` values of `type` (u8 i8 u16 i32 u32 u64 f32 f64) at byte
// `offset`.
struct FrameField {
  std::string name;
  std::uint32_t offset = 0;
  std::string type;
  std::uint32_t count = 1;
  FrameKind kind = FrameKind::kNumber;
  std::string comment = {};  // unit, frame and meaning
};

// Returns the fields that PackFrame writes. They are the fields of core/tick_fields.h that have a
// name for the page, and the viewer's additions.
const std::vector<FrameField>& FrameFields();
std::size_t FrameBytes();

// The largest force [N] and torque [N·m] of each hand on its handle over several ticks, so that the
// page also shows peaks between two messages.
struct Peaks {
  void See(const TickRecord& record);
  std::array<std::array<float, 2>, kHands> hands = {};
};

// Returns the record as a binary message. `peaks` are the peaks since the previous message.
// `sent_ns` is the time of the monotonic clock [ns]. `recording` states whether the run is being
// recorded.
std::string PackFrame(const TickRecord& record, const Peaks& peaks, std::uint64_t sent_ns,
                      bool recording);

// Returns the text of web/src/quantities.ts, which contains the names of states, causes and
// quantities, and the fields as TypeScript types.
std::string PageQuantities();
// Returns the text of web/src/person_state.ts, which contains the type of a person's state, and its
// tables.
std::string PagePerson();

}  // namespace predictor::viewer
