// A tick's record as the page gets it: packed, little-endian, described by a table.
#pragma once

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

// The record as a binary message. sent_ns: monotonic clock [ns]; `recording`: the run is recorded.
std::string PackFrame(const TickRecord& record, std::uint64_t sent_ns, bool recording);

}  // namespace predictor
