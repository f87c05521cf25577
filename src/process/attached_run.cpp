#include "process/attached_run.h"

#include <filesystem>
#include <stdexcept>

#include "scenario/scenario_io.h"

namespace predictor {

Json RunLine(const Scenario& scenario, const Vector3& p) {
  return {{"scenario", SaveScenario(scenario)},
          {"file", scenario.file.filename().string()},
          {"folder", std::filesystem::absolute(scenario.file).parent_path().string()},
          {"object_start", {p.x(), p.y(), p.z()}}};
}

AttachedRun::AttachedRun(const Json& start)
    : board(kBoardDescriptor, false),
      scenario(
          ParseScenario(start["scenario"], start["file"], start["folder"].get<std::string>())) {
  if ((*board).magic != RunBoard::kMagic || (*board).bytes != sizeof(RunBoard))
    throw std::runtime_error("The shared memory does not belong to a run of this program version.");
  for (int i = 0; i < 3; ++i)
    object_start[i] = start["object_start"][static_cast<std::size_t>(i)].get<double>();
}

}  // namespace predictor
