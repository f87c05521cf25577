// A shared library that contains a controller.
#pragma once

#include <predictor/controller.h>

#include <filesystem>
#include <memory>

#include "simulation/plugin_calls.h"

namespace predictor {

class PluginLibrary {
 public:
  // Loads the library that `calls` names. The loading already runs code of the library. Throws
  // InputError, which states why the library cannot be used. `calls` is borrowed.
  explicit PluginLibrary(const std::filesystem::path& file, PluginCalls* calls);

  const PredictorController& functions() const { return *functions_; }

 private:
  struct Closer {
    PluginCalls* calls;
    void operator()(void* handle) const;
  };
  std::unique_ptr<void, Closer> handle_;
  const PredictorController* functions_;
};

}  // namespace predictor
