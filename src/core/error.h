// The exception that is thrown if loading fails. The exception states the error, the place of the
// error, and the remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace predictor {

// Reports invalid input, which is found before anything moves. The function what() returns one or
// more full sentences for the user, prefixed by "file:line:column: " if the place is known.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& sentence) : std::runtime_error(sentence) {}
  InputError(const std::string& place, const std::string& sentence)
      : std::runtime_error(place.empty() ? sentence : place + ": " + sentence) {}

  // Returns an error in the value at `key` of a scenario ("device.arms.left.elbow"). Located
  // (scenario/located.h) adds the place of the key in the file. `sentence` begins with the key.
  static InputError At(const std::string& key, const std::string& sentence) {
    InputError error(sentence);
    error.key_ = key;
    return error;
  }
  // Returns this error with its key prefixed by a group: "velocity_limit" in the group
  // "device.arms.left" becomes "device.arms.left.velocity_limit". An error without a key (for
  // example, in a model file) is attributed to `group`, and its sentence names the group.
  InputError Within(const std::string& group) const {
    if (key_.empty()) return At(group, group + ": " + what());
    return At(group + "." + key_, group + "." + what());
  }

  // The key in the scenario, or "" if the error has no key or its message already contains the
  // place.
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

}  // namespace predictor
