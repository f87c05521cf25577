// Writes the safety of the collaboration as text, JSON and tables.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "assessment/safety/safety.h"

namespace predictor::assessment {

std::string SafetyText(const SafetyAssessment& safety);
nlohmann::ordered_json SafetyJson(const SafetyAssessment& safety);
nlohmann::ordered_json SafetySchema();  // JSON Schema (draft-07) of SafetyJson

// The content that the text and the page have in common.
struct SafetyTable {
  std::string title;
  std::string origin;                          // "measured", ...
  std::vector<std::vector<std::string>> rows;  // the first row is the header; its first cell is
                                               // empty
  std::vector<std::string> notes;              // sentences below the table
};
std::vector<SafetyTable> SafetyTables(const SafetyAssessment& safety);

}  // namespace predictor::assessment
