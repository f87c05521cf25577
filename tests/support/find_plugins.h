// Locates the plug-ins in the build folder. A test that uses them depends on the target `plugins`.
#pragma once

#include <cstdlib>
#include <string>

namespace predictor::test {

// Lets scenarios find the libraries as package://plugins/NAME.so.
inline void FindPlugins() {
  const std::string program = PREDICTOR_BINARY;
  const std::string build = program.substr(0, program.rfind("/bin/"));
  setenv("PREDICTOR_PACKAGE_PATH", (build + "/lib/plugins").c_str(), 1);
}

}  // namespace predictor::test
