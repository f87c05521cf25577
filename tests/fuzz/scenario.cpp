// Parses any text as a scenario, as a machine file and as waypoints. The parsers must accept the
// text or throw InputError.
#include "core/error.h"
#include "fuzz/target.h"
#include "scenario/machine.h"
#include "scenario/scenario_io.h"
#include "scenario/trajectory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    predictor::ParseScenario(text, "fuzz.yaml", ".");
  } catch (const predictor::InputError&) {
  }
  try {
    predictor::ParseMachine(text, "fuzz.yaml");
  } catch (const predictor::InputError&) {
  }
  try {
    predictor::ParseWaypoints(text, "fuzz.csv");
  } catch (const predictor::InputError&) {
  }
  return 0;
}
