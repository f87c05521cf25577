// Gives access to the numbers of a record by name. These names are used in tables and in the
// message that states which quantity of two records differs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

// One number of a record, for example "hands.left.wrench.force.x" or "cobot.q[3]".
struct Column {
  std::string name;
  std::string type;         // of the number in a recording, for example "float64"
  std::string unit, frame;  // texts as in core/tick_fields.h; may be ""
  std::string meaning;
  std::size_t offset = 0, size = 0;  // position in TickRecord [bytes]
  std::string (*text)(const std::byte* number) = nullptr;
  bool of_clock = false;  // measured by the computer's clock, so a replay does not reproduce it
  bool of_input = false;  // part of an input from a person or a page
  // The number exists in a record only if the byte at each `offset` exceeds `above`. Numbers of
  // absent hands and joints do not exist.
  struct Condition {
    std::size_t offset, above;
  };
  std::vector<Condition> conditions = {};

  bool ExistsIn(const TickRecord& record) const;
  // Writes as many digits as are needed to read the same number back from the text.
  std::string Text(const TickRecord& record) const { return text(At(record)); }
  std::uint64_t Bits(const TickRecord& record) const;
  const std::byte* At(const TickRecord& record) const {
    return reinterpret_cast<const std::byte*>(&record) + offset;
  }
};

// Gives each column of a cobot's joint the unit of this joint. prismatic[j] states whether joint j
// is prismatic. Without this call, such a column has the units of both kinds of joints ("rad or
// m").
void SetJointUnits(const std::vector<bool>& prismatic, std::vector<Column>* columns);

// Returns all numbers of a record in the order of its messages (core/tick_fields.h).
const std::vector<Column>& AllColumns();

// Returns the columns that exist in `record`, without absent hands and joints. Columns of inputs
// are optional, because they outnumber all others and are empty in most ticks.
enum class InputColumns { kLeftOut, kIncluded };
std::vector<Column> ColumnsOf(const TickRecord& record,
                              InputColumns inputs = InputColumns::kLeftOut);

// Returns the columns whose names match one of the patterns. `*` matches any text, and the name of
// a group, such as "hands.left", selects the whole group. Throws InputError with the most similar
// name if a pattern matches no column.
std::vector<Column> Select(const std::vector<Column>& columns,
                           const std::vector<std::string>& patterns);

}  // namespace predictor
