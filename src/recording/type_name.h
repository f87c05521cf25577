// Names of the types of numbers in ROS 2 messages.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>

namespace predictor::recording {

// Returns a name such as "float64" or "uint8". An enumeration has the name of its integer.
template <class T>
std::string TypeName() {
  if constexpr (std::is_enum_v<T>) {
    return TypeName<std::underlying_type_t<T>>();
  } else if constexpr (std::is_floating_point_v<T>) {
    return "float" + std::to_string(8 * sizeof(T));
  } else {
    return (std::is_signed_v<T> ? "int" : "uint") + std::to_string(8 * sizeof(T));
  }
}

}  // namespace predictor::recording
