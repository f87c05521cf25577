// The stream of a recording that contains the measured poses of the person's head.
#pragma once

#include <string>
#include <string_view>

#include "core/head_record.h"
#include "recording/header.h"

namespace predictor::recording {

// Returns {"p": …, "q": …, "delay": …, "registration": {…}} on one line. The message's time is the
// time of the pose, so the text does not contain it.
std::string HeadJson(const HeadRecord& head);
std::string HeadSchema();  // JSON Schema (draft-07) of HeadJson

// Reads HeadJson. Returns false if the text is something else, or the head is not plausible (see
// IsPlausible). Leaves `wall_ns` and `client` unchanged.
bool ParseHead(std::string_view text, HeadRecord* head);

}  // namespace predictor::recording
