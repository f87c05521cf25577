// The JSON form of token generations in messages between the run and the viewer's process.
#pragma once

#include "process/control_channel.h"
#include "viewer/admission.h"

namespace predictor::viewer {

inline Json ToJson(const Generations& g) { return {g.pages, g.watchers}; }

inline Generations GenerationsOf(const Json& json) {
  return {json[0].get<std::uint32_t>(), json[1].get<std::uint32_t>()};
}

}  // namespace predictor::viewer
