// The numbers of a record by name: for tables, and to say where two records differ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

enum class NumberKind : std::uint8_t { kU8, kI8, kU16, kI32, kU32, kU64, kF32, kF64 };

// One number of a record, as "hands.left.wrench.force.x" or "cobot.q[3]".
struct Column {
  std::string name;
  std::string unit;  // "" if it has none, or is a count
  std::size_t offset = 0;
  NumberKind kind = NumberKind::kF64;

  // In full: what is read back from it is the same number.
  std::string Text(const TickRecord& record) const;
  std::uint64_t Bits(const TickRecord& record) const;
};

// Of everything in a record, in the order of its messages (fields.h).
const std::vector<Column>& AllColumns();

// Those that exist in `record`: without absent hands and joints. Those of the inputs, which few
// ticks have and which are more than all others, only if asked for.
enum class InputColumns { kLeftOut, kIncluded };
std::vector<Column> ColumnsOf(const TickRecord& record,
                              InputColumns inputs = InputColumns::kLeftOut);

// Those whose names match one of the patterns, in which `*` stands for anything; of a group,
// "hands.left" for all of it. Throws InputError for a pattern that matches none, with the nearest
// name.
std::vector<Column> Select(const std::vector<Column>& columns,
                           const std::vector<std::string>& patterns);

}  // namespace predictor
