// The commands that a tick sends to both arms.
#pragma once

#include <array>

#include "core/record.h"

namespace predictor {

using Arms = std::array<JointVector, kHands>;

inline Arms CommandOf(const TickRecord& record) {
  Arms v;
  for (std::size_t i = 0; i < kHands; ++i)
    v[i] = Eigen::Map<const JointVector>(record.hands[i].command.data(), record.hands[i].arm_dof);
  return v;
}

}  // namespace predictor
