#include "ergonomics/reference_postures.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace predictor::ergonomics {
namespace {

double* AngleOf(ReferencePosture* p, const std::string& input) {
  const std::map<std::string, double*> angles = {
      {"neck_flexion", &p->body.neck_flexion},
      {"neck_side_bend", &p->body.neck_side_bend},
      {"neck_twist", &p->body.neck_twist},
      {"trunk_flexion", &p->body.trunk_flexion},
      {"trunk_side_bend", &p->body.trunk_side_bend},
      {"trunk_twist", &p->body.trunk_twist},
      {"knee_flexion", &p->body.knee_flexion},
      {"upper_arm_flexion", &p->arm.upper_arm_flexion},
      {"upper_arm_abduction", &p->arm.upper_arm_abduction},
      {"upper_arm_rotation", &p->arm.upper_arm_rotation},
      {"elbow_flexion", &p->arm.elbow_flexion},
      {"forearm_rotation", &p->arm.forearm_rotation},
      {"wrist_flexion", &p->arm.wrist_flexion},
      {"wrist_deviation", &p->arm.wrist_deviation}};
  const auto found = angles.find(input);
  return found == angles.end() ? nullptr : found->second;
}

bool* FlagOf(ReferencePosture* p, const std::string& input) {
  const std::map<std::string, bool*> flags = {
      {"on_both_feet", &p->body.on_both_feet},
      {"sitting", &p->body.sitting},
      {"shoulder_raised", &p->arm.shoulder_raised},
      {"supported", &p->arm.supported},
      {"across_or_out", &p->arm.across_or_out},
      {"shock", &p->exertion.shock},
      {"held", &p->exertion.held},
      {"repeated", &p->exertion.repeated},
      {"large_rapid_change", &p->exertion.large_rapid_change}};
  const auto found = flags.find(input);
  return found == flags.end() ? nullptr : found->second;
}

void Set(ReferencePosture* posture, const std::string& input, double value) {
  if (double* angle = AngleOf(posture, input))
    *angle = Degrees(value);
  else if (bool* flag = FlagOf(posture, input))
    *flag = value != 0;
  else if (input == "load")
    posture->exertion.load = value;
  else if (input == "coupling")
    posture->exertion.coupling = static_cast<Coupling>(static_cast<int>(value));
  else
    throw std::runtime_error("unknown input " + input);
}

}  // namespace

std::vector<ReferencePosture> ReadPostures(const std::string& name) {
  std::ifstream file(std::string(PREDICTOR_SOURCE_DIR) + "/tests/ergonomics/" + name);
  std::vector<ReferencePosture> postures;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind, key;
    if (!(words >> kind >> key) || kind == "#") continue;
    if (kind == "posture") {
      postures.push_back({key, {}, {}, {}, {}, {}});
      continue;
    }
    double value = 0;
    if (postures.empty() || !(words >> value)) throw std::runtime_error("bad line: " + line);
    if (kind == "set")
      Set(&postures.back(), key, value);
    else if (kind == "rula")
      postures.back().rula[key] = static_cast<int>(value);
    else if (kind == "reba")
      postures.back().reba[key] = static_cast<int>(value);
    else
      throw std::runtime_error("bad line: " + line);
  }
  return postures;
}

}  // namespace predictor::ergonomics
