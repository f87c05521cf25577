// A tick's record as the page gets it: packed, little-endian, described by a table.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

// One entry of `welcome.frame`: `count` values of `type` (u8 i8 u16 i32 u32 u64 f32 f64) at byte
// `offset`.
struct FrameField {
  std::string name;
  std::uint32_t offset = 0;
  std::string type;
  std::uint32_t count = 1;
};

// The table, out of the same list that PackFrame goes through.
const std::vector<FrameField>& FrameFields();
std::size_t FrameBytes();

// Largest force and torque of each hand on its handle [N], [N·m], over several ticks: what happens
// between two messages must be seen too.
struct Peaks {
  void See(const TickRecord& record);
  std::array<std::array<float, 2>, kHands> hands = {};
};

// The record as a binary message. peaks: since the message before. sent_ns: monotonic clock [ns];
// `recording`: the run is recorded.
std::string PackFrame(const TickRecord& record, const Peaks& peaks, std::uint64_t sent_ns,
                      bool recording);

}  // namespace predictor
