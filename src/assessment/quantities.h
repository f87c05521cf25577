// Table of the quantities that are reported for the person over time, for text, JSON, CSV and page.
#pragma once

#include <span>

#include "assessment/frame.h"
#include "assessment/hand_samples.h"
#include "evaluation/metric.h"

namespace predictor::assessment {

// The origin of a number. Every output shows it.
enum class Origin {
  kMeasured,  // measured by the sensors of the arms
  kModelled,  // computed by the model of the person's body
  kStandard,  // computed by a published method or worksheet, from measured and modelled values
};
const char* Name(Origin origin);
// Returns "simulated sensor" instead of "measured" if the operator was simulated.
const char* Name(Origin origin, bool simulated);

struct Moment {
  const Frame& frame;
  const PersonSample& sample;
};

// Which values are bad.
enum class Bad { kHigh, kLow };

struct QuantityKind {
  const char* path;   // key in JSON and CSV, ending in the SI unit
  const char* group;  // heading in tables and plots
  const char* label;
  Unit unit;
  Origin origin;
  double (*of)(const Moment&);  // null: one value for the whole run (see ActivityRatioKind)
  double limit = 0;             // a published limit, in SI units; 0: none
  const char* limit_name = "";  // its source
  int hand = -1;                // the hand that the quantity belongs to; -1: neither
  Bad bad = Bad::kHigh;
  bool nominal_only = false;  // not computed for the possible postures
  bool of_joint = false;  // a cell in the table of joints (see JointTable), not a row of its own
  bool only_in_files = false;  // too uncertain for tables and plots; JSON and CSV contain it

  bool has_row() const { return !of_joint && !only_in_files; }
};
std::span<const QuantityKind> Quantities();

// A worksheet, with the functions that compute the score of a frame and the action for a score.
struct WorksheetKind {
  const char* name;
  int most;  // highest score
  int (*of)(const Frame&);
  ergonomics::Action (*action)(int score);
};
std::span<const WorksheetKind> Worksheets();

}  // namespace predictor::assessment
