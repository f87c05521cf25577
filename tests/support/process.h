// Helpers for tests of helper processes.
#pragma once

#include <chrono>
#include <fstream>
#include <string>
#include <thread>

namespace predictor::test {

// Waits at most twenty seconds for `condition`.
template <class Condition>
bool Becomes(Condition condition) {
  for (int i = 0; i < 2000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

// Returns a field of /proc/PID/status, or an empty text if there is none.
inline std::string StatusOf(int pid, const std::string& field) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(field + ":")) return line.substr(field.size() + 2);
  return "";
}

}  // namespace predictor::test
