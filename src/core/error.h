// The error that loading throws: it says what is wrong, where, and what to change.
#pragma once

#include <stdexcept>
#include <string>

namespace predictor {

// Bad input, found before anything moves. what() is one or more full sentences for a person,
// prefixed "file:line:column: " where a place is known.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& sentence) : std::runtime_error(sentence) {}
  InputError(const std::string& place, const std::string& sentence)
      : std::runtime_error(place.empty() ? sentence : place + ": " + sentence) {}

  // Concerns the value at `key` of a scenario ("device.arms.left.elbow"), whose place in the file
  // is not known here: Located (scenario/located.h) adds it. `sentence` begins with the key.
  static InputError At(const std::string& key, const std::string& sentence) {
    InputError error(sentence);
    error.key_ = key;
    return error;
  }
  // The same of a key within a group: "velocity_limit" within "device.arms.left". Of what concerns
  // no key, as an error within a model's file: of that `group`, which the sentence then names.
  InputError Within(const std::string& group) const {
    if (key_.empty()) return At(group, group + ": " + what());
    return At(group + "." + key_, group + "." + what());
  }

  // Of the scenario; "" if the error concerns none, or tells the place already.
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

}  // namespace predictor
