// Finds the position of a quantity in a state message by the name that the page uses.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "viewer/frame.h"

namespace predictor::viewer {

// Returns the number of bytes from the start of the message. Throws std::out_of_range for an
// unknown name.
inline std::size_t FrameOffset(const std::string& name) {
  for (const FrameField& field : FrameFields())
    if (field.name == name) return field.offset;
  throw std::out_of_range(name);
}

}  // namespace predictor::viewer
