// A controller in a shared library that implements the C interface predictor/controller.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "scenario/paths.h"
#include "scenario/trial_note.h"
#include "simulation/allocation_count.h"
#include "simulation/controllers/controllers.h"
#include "simulation/external_controller.h"
#include "simulation/plugin_calls.h"
#include "simulation/plugin_library.h"

namespace predictor::controllers {
namespace {

constexpr std::size_t kErrorBytes = 1000;

struct PluginParameters {
  std::string library;
  std::string parameters;
};

template <class V>
void Fields(V& v, PluginParameters& p) {
  v("library", p.library,
    Required(Word("shared library: package://..., or relative to this file; it runs as part of "
                  "the program")));
  v("parameters", p.parameters, Word("parameters for the library: key=value, separated by spaces"));
}

std::filesystem::path LibraryOf(const ControllerContext& context,
                                const PluginParameters& parameters) {
  std::filesystem::path file;
  try {
    file = ResolveModelPath(parameters.library, context.folder);
  } catch (const InputError& error) {
    throw error.Within("cobot.controller.library");
  }
  if (!context.distrusts_libraries || HasPassedTrial(file, parameters.parameters)) return file;
  throw InputError::At("cobot.controller.library",
                       "cobot.controller.library: " + parameters.library +
                           " would run as part of the control loop. Before use with real arms, the "
                           "library must pass a trial with the same parameters: run `predictor "
                           "trial SCENARIO RECORDING`. Or use cobot.controller.type: process.");
}

class Plugin final : public ExternalController {
 public:
  Plugin(const ControllerContext& context, const PluginParameters& parameters)
      : ExternalController(context),
        file_(LibraryOf(context, parameters)),
        calls_(file_.string()),
        library_(file_, &calls_),
        functions_(library_.functions()),
        self_(Make(context, parameters), Destroyer{this}) {
    if (functions_.memory) FindMemory(parameters);
    AskForInput();
    BeginAllocationCount();  // now all libraries that this library needs are loaded
  }

  std::span<double> memory() noexcept override { return memory_; }
  bool uses_wrist_sensor() const noexcept override { return uses_wrist_sensor_; }
  void SetUp(bool begins) noexcept override { is_set_up_ = !begins; }
  void Start(const ControllerInput& input) noexcept override {
    failed_ = false;
    if (functions_.start) Guard("start", [&] { functions_.start(self_.get(), &Fill(input)); });
  }
  void Advance(const ControllerInput& input, double) noexcept override {
    if (functions_.advance)
      Guard("advance", [&] { functions_.advance(self_.get(), &Fill(input)); });
  }
  double StoredEnergy(const ControllerInput& input) const noexcept override {
    if (!functions_.stored_energy) return 0;
    double energy = 0;
    Guard("stored_energy", [&] { energy = functions_.stored_energy(self_.get(), &Fill(input)); });
    return IsUsable(energy) ? energy : 0;
  }

 private:
  Answer Ask(const PredictorControllerInput& input, double* torque) noexcept override {
    Guard("compute", [&] { functions_.compute(self_.get(), &input, torque); });
    if (failed_ || !std::all_of(memory_.begin(), memory_.end(), IsUsable)) torque[0] = std::nan("");
    Answer answer;
    answer.allocations = std::exchange(allocations_, 0);
    return answer;
  }

  // A C++ exception must not leave the library. If an exception leaves the library, the program
  // refuses the library's next torques. The allocations are counted, because a function that
  // allocates memory may wait for a lock or for the system.
  template <class Call>
  void Guard(const char* function, Call call) const noexcept {
    const PluginCall running(&calls_, function);
    const std::int64_t before = AllocationCalls();
    try {
      call();
    } catch (...) {
      failed_ = true;
    }
    if (is_set_up_) allocations_ += AllocationCalls() - before;
  }

  void* Make(const ControllerContext& context, const PluginParameters& given);
  void FindMemory(const PluginParameters& parameters);
  void AskForInput();
  struct Destroyer {
    Plugin* plugin;
    void operator()(void* self) const {
      const PluginCall call(&plugin->calls_, "destroy", PluginCall::Kind::kPreparation);
      plugin->functions_.destroy(self);
    }
  };

  const std::filesystem::path file_;
  mutable PluginCalls calls_;
  PluginLibrary library_;
  const PredictorController& functions_;
  std::unique_ptr<void, Destroyer> self_;
  std::span<double> memory_;
  bool uses_wrist_sensor_ = false;
  mutable bool failed_ = false;           // since the last Start
  bool is_set_up_ = false;                // the control loop calls the functions
  mutable std::int64_t allocations_ = 0;  // in the loop, since the last Ask
};

void* Plugin::Make(const ControllerContext& context, const PluginParameters& given) {
  const int dof = context.model.dof();
  PredictorControllerConfig config{};
  config.dof = dof;
  std::vector<const char*> names;
  for (int j = 0; j < dof; ++j) names.push_back(context.model.joint_name(j).c_str());
  config.joint_names = names.data();
  const std::vector<InterfaceParameter> parameters = InterfaceParameters(given.parameters);
  std::vector<PredictorParameter> words;
  for (const auto& [key, value] : parameters) words.push_back({key.c_str(), value.c_str()});
  config.parameters = words.data();
  config.parameter_count = static_cast<std::int32_t>(words.size());
  std::copy_n(context.posture.data(), dof, config.posture);
  FillPose(context.X_WE_start, config.X_WE_start);
  config.gravity = context.gravity;
  config.dt = context.period;
  std::array<char, kErrorBytes> error{};
  const PluginCall call(&calls_, "create", PluginCall::Kind::kPreparation);
  void* self = functions_.create(&config, error.data(), error.size() - 1);
  if (self) return self;
  const std::string why = error[0] ? Printable(error.data()) : "It gives no reason.";
  throw InputError::At("cobot.controller.library", "cobot.controller.library: " + given.library +
                                                       " refuses this scenario. " + why);
}

void Plugin::FindMemory(const PluginParameters& parameters) {
  std::int32_t size = 0;
  const PluginCall call(&calls_, "memory");
  double* numbers = functions_.memory(self_.get(), &size);
  if (size < 0 || size > PREDICTOR_MAX_MEMORY || (size > 0 && !numbers))
    throw InputError::At("cobot.controller.library",
                         "cobot.controller.library: " + parameters.library + " has a memory of " +
                             std::to_string(size) + " numbers; it must have from 0 to " +
                             std::to_string(PREDICTOR_MAX_MEMORY) + ".");
  memory_ = {numbers, static_cast<std::size_t>(size)};
}

// Asks which parts of the input the controller needs.
void Plugin::AskForInput() {
  if (functions_.uses_wrist_sensor) {
    const PluginCall call(&calls_, "uses_wrist_sensor");
    uses_wrist_sensor_ = functions_.uses_wrist_sensor(self_.get()) != 0;
  }
  if (functions_.reads) {
    const PluginCall call(&calls_, "reads");
    RestrictInput(functions_.reads(self_.get()));
  }
}

}  // namespace

const ControllerKind kPlugin = ControllerKindOf<Plugin, PluginParameters>(
    "plugin", "your own shared library, in C or C++", ControllerPlace::kLibrary);

}  // namespace predictor::controllers
