// The results of a finished run for the viewer's pages: figures, curves over time, and the report.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/record.h"
#include "evaluation/summary.h"
#include "scenario/scenario.h"

namespace predictor {

// The largest force and the largest tracking error in each piece of a run. A run of any length is
// divided into at most 240 pieces.
class ResultCurves {
 public:
  explicit ResultCurves(const Scenario& scenario);
  // Call this in order. Ticks outside RUN are ignored. After a reset, the curves start again.
  void Add(const TickRecord& record);
  // Returns the curves as JSON: [{"title", "unit", "limit", "step": s, "left": [...] | null,
  // "right": ...}, ...].
  nlohmann::ordered_json ToJson() const;

 private:
  static constexpr std::size_t kPieces = 240;
  struct Piece {
    std::array<double, kHands> force = {}, distance = {};  // maxima [N], [m]
  };
  void Halve();

  std::array<bool, kHands> present_;
  double force_limit_, distance_limit_;  // [N], [m]
  double step_ = 0.05;                   // duration of a piece [s]
  double time_ = 0;                      // time of the last tick [s]
  std::vector<Piece> pieces_;
};

// Returns the page's `scene.results`. `how` is a sentence about how the run ended. `recording` is
// the file of the recording, or empty. `remark` is the reason why there is no report, or empty.
nlohmann::ordered_json ResultsJson(const Summary& summary, const ResultCurves& curves,
                                   const std::string& how, const std::string& recording,
                                   const std::string& remark);

// Writes the report of a recording to the folder of the recording. Returns the report's file, or an
// empty path and the reason in `remark`. `duration` is the duration of the run [s]. If `force` is
// true, the program replaces an existing report. For long runs, the user must make the report with
// `predictor report`.
std::filesystem::path WriteRunReport(const std::string& recording, double duration, bool force,
                                     std::string* remark);

}  // namespace predictor
