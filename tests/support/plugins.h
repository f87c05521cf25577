// Controllers outside the program, for tests. A test that uses them depends on the target
// `plugins`.
#pragma once

#include <string>

#include "scenario/scenario.h"
#include "support/find_plugins.h"

namespace predictor::test {

// Returns "NAME.so" of examples/plugins or tests/plugins with its parameters.
inline ControllerSpec Plugin(const std::string& name, const std::string& parameters = "") {
  FindPlugins();
  ControllerSpec spec{"plugin", {}};
  spec.Set("library=package://plugins/" + name + ".so");
  if (!parameters.empty()) spec.Set("parameters=\"" + parameters + "\"");
  return spec;
}

// Returns a program and its arguments in YAML, such as "[python3, -c, ...]".
inline ControllerSpec ProcessOf(const std::string& command, const std::string& parameters = "") {
  ControllerSpec spec{"process", {}};
  spec.Set("command=" + command);
  if (!parameters.empty()) spec.Set("parameters=\"" + parameters + "\"");
  return spec;
}
inline ControllerSpec PythonExample(const std::string& parameters = "") {
  return ProcessOf(
      "[python3, " + std::string(PREDICTOR_SOURCE_DIR) + "/examples/plugins/joint_impedance.py]",
      parameters);
}

}  // namespace predictor::test
