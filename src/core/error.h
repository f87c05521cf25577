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
};

}  // namespace predictor
