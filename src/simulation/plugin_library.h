// A shared library that contains a controller.
#pragma once

#include <predictor/controller.h>

#include <filesystem>
#include <memory>

namespace predictor {

class PluginLibrary {
 public:
  // Loads the library, which runs code in it. Throws InputError that states what does not fit.
  explicit PluginLibrary(const std::filesystem::path& file);

  const PredictorController& functions() const { return *functions_; }

 private:
  struct Closer {
    void operator()(void* handle) const;
  };
  std::unique_ptr<void, Closer> handle_;
  const PredictorController* functions_;
};

}  // namespace predictor
