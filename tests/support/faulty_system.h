// While an object of this class exists, new programs start on a faulty system (faulty_system.cpp).
#pragma once

#include <cstdlib>
#include <string>

namespace predictor {

class FaultySystem {
 public:
  FaultySystem(const std::string& fault, const std::string& value) : fault_(fault) {
    if (const char* others = std::getenv("LD_PRELOAD")) others_ = others;
    setenv("LD_PRELOAD", (PREDICTOR_FAULTY_SYSTEM " " + others_).c_str(), 1);
    setenv(fault.c_str(), value.c_str(), 1);
  }
  ~FaultySystem() {
    if (others_.empty())
      unsetenv("LD_PRELOAD");
    else
      setenv("LD_PRELOAD", others_.c_str(), 1);
    unsetenv(fault_.c_str());
  }
  FaultySystem(const FaultySystem&) = delete;
  FaultySystem& operator=(const FaultySystem&) = delete;

 private:
  std::string fault_, others_;  // others: libraries that are preloaded in any case
};

}  // namespace predictor
