// The table of what is reported of the person over time. Text, JSON, CSV and page derive from it.
#pragma once

#include <span>

#include "assessment/frame.h"
#include "assessment/hand_samples.h"
#include "evaluation/metric.h"

namespace predictor::assessment {

// How a number was obtained. Every output shows it.
enum class Origin {
  kMeasured,  // by the sensors of the arms
  kModelled,  // by the model of the person's body
  kStandard,  // by a published method or worksheet, from measured and modelled values
};
const char* Name(Origin origin);

struct Moment {
  const Frame& frame;
  const PersonSample& sample;
};

// Which values are bad.
enum class Bad { kHigh, kLow };

struct QuantityKind {
  const char* path;   // key in JSON and CSV, ending in the SI unit
  const char* group;  // of a table and a plot
  const char* label;
  Unit unit;
  Origin origin;
  double (*of)(const Moment&);
  double limit = 0;             // a published limit, SI; 0: none
  const char* limit_name = "";  // its source
  int hand = -1;                // whose quantity it is; -1: of no single hand
  Bad bad = Bad::kHigh;
  bool nominal_only = false;  // not computed for the possible postures
};
std::span<const QuantityKind> Quantities();

// A worksheet: its score of a frame, and the action for a score.
struct WorksheetKind {
  const char* name;
  int most;  // highest score
  int (*of)(const Frame&);
  ergonomics::Action (*action)(int score);
};
std::span<const WorksheetKind> Worksheets();

}  // namespace predictor::assessment
