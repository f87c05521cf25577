// Reads the files of scored postures.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ergonomics/posture.h"

namespace predictor::ergonomics {

struct ReferencePosture {
  std::string name;
  BodyPosture body;
  ArmPosture arm;
  Exertion exertion;
  std::map<std::string, int> rula, reba;  // score -> value
};

// Reads a file of this folder. Throws std::runtime_error if a line has an unknown format.
std::vector<ReferencePosture> ReadPostures(const std::string& name);

}  // namespace predictor::ergonomics
