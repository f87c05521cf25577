// While an object of this class exists, new programs start on a faulty system (faulty_system.cpp).
#pragma once

#include <cstdlib>
#include <string>

namespace predictor {

class FaultySystem {
 public:
  FaultySystem(const std::string& fault, const std::string& value) : fault_(fault) {
    setenv("LD_PRELOAD", PREDICTOR_FAULTY_SYSTEM, 1);
    setenv(fault.c_str(), value.c_str(), 1);
  }
  ~FaultySystem() {
    unsetenv("LD_PRELOAD");
    unsetenv(fault_.c_str());
  }
  FaultySystem(const FaultySystem&) = delete;
  FaultySystem& operator=(const FaultySystem&) = delete;

 private:
  std::string fault_;
};

}  // namespace predictor
