// Provides the parts that the plots of a report have in common.
#pragma once

#include <cstddef>
#include <string>

#include "core/types.h"
#include "report/run_plots.h"

namespace predictor {

inline constexpr std::size_t kMaxNotes = 10;
inline constexpr int kPair = 2;  // colour of curves that concern both handles

inline bool Single(const Runs& runs) { return runs.size() == 1; }

// Returns the first run, with which all others are compared.
inline const RunData& First(const Runs& runs) { return runs.front().run(); }

inline std::string LabelOf(const Runs& runs, std::size_t r) { return runs[r].run().info.name; }

inline PlotAxis Axis(const std::string& label, const std::string& unit, double least = 0,
                     bool zero = true) {
  return {.label = label, .unit = unit, .zero = zero, .least = least};
}

inline PlotLimit LimitAt(double value, const std::string& label, const char* unit) {
  const std::string gap = *unit == '\0' || std::string(unit) == "°" ? "" : " ";
  return {value, label + " " + Round(value, 3) + gap + unit};
}

}  // namespace predictor
