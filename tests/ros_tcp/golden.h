// Messages as bytes that ROS itself has written (golden.py).
#pragma once

#include <fstream>
#include <map>
#include <string>

namespace predictor::ros_tcp {

inline std::string Bytes(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i < hex.size();) {
    if (hex[i] == ' ') {
      ++i;
      continue;
    }
    bytes.push_back(static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
    i += 2;
  }
  return bytes;
}

// Returns the bytes by name and dialect, for example "pose ROS1".
inline std::map<std::string, std::string> Golden() {
  std::map<std::string, std::string> golden;
  std::ifstream file(std::string(PREDICTOR_SOURCE_DIR) + "/tests/ros_tcp/golden.txt");
  for (std::string name, dialect, hex; file >> name >> dialect >> hex;)
    golden[name + " " + dialect] = Bytes(hex);
  return golden;
}

}  // namespace predictor::ros_tcp
