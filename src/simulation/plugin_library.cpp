#include "simulation/plugin_library.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

constexpr const char* kKey = "cobot.controller.library";

[[noreturn]] void Refuse(const std::filesystem::path& file, const std::string& why) {
  throw InputError::At(kKey, std::string(kKey) + ": " + file.string() + " " + why);
}

std::string LoaderError() {
  const char* text = dlerror();
  return text ? Printable(text) : "unknown error";
}

}  // namespace

void PluginLibrary::Closer::operator()(void* handle) const {
  const PluginCall call(calls, "dlclose", PluginCall::Kind::kPreparation);
  dlclose(handle);
}

PluginLibrary::PluginLibrary(const std::filesystem::path& file, PluginCalls* calls)
    : handle_(nullptr, Closer{calls}), functions_(nullptr) {
  const PluginCall call(calls, "dlopen", PluginCall::Kind::kPreparation);
  handle_.reset(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL));
  if (!handle_)
    Refuse(file, "could not be loaded: " + LoaderError() +
                     ". Build it as a shared library for this computer, together with all "
                     "libraries that it needs.");
  const auto entry =
      reinterpret_cast<PredictorControllerEntry>(dlsym(handle_.get(), "predictor_controller"));
  if (!entry)
    Refuse(file,
           "does not export predictor_controller. Define this function as in "
           "predictor/controller.h, with PREDICTOR_EXPORT (in C++, extern \"C\").");
  functions_ = entry();
  if (!functions_)
    Refuse(file, "returns NULL from predictor_controller. Return the address of a constant table.");
  const PredictorController& f = *functions_;
  if (f.version != PREDICTOR_CONTROLLER_VERSION || f.input_size != sizeof(PredictorControllerInput))
    Refuse(file,
           "has version " + std::to_string(f.version) + " of the controller interface (" +
               std::to_string(f.input_size) + " bytes of input), but this program has " +
               std::to_string(PREDICTOR_CONTROLLER_VERSION) + " (" +
               std::to_string(sizeof(PredictorControllerInput)) +
               " bytes). Compile the library with the predictor/controller.h of this version.");
  if (!f.create || !f.destroy || !f.compute)
    Refuse(file, "lacks create, destroy or compute, which every controller needs.");
}

}  // namespace predictor
