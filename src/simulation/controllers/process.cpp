// A controller in a separate process that uses the shared memory of predictor/controller.h.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/real_time.h"
#include "core/text.h"
#include "simulation/controller_process.h"
#include "simulation/controllers/controllers.h"
#include "simulation/external_controller.h"

namespace predictor::controllers {
namespace {

constexpr double kStartTime = 30;        // for the program to start [s]
constexpr double kLongestWait = 10;      // for an answer in virtual time [s]
constexpr double kLongestSilence = 0.1;  // in real time [s]

struct ProcessParameters {
  std::vector<std::string> command;
  std::string parameters;
  double deadline = 3e-4;  // [s]
  bool real_time_priority = false;
};

template <class V>
void Fields(V& v, ProcessParameters& p) {
  v("command", p.command,
    List(Required(Word("the program and its arguments; it starts in the folder of this file")), 1,
         32));
  v("parameters", p.parameters, Word("parameters for the program: key=value, separated by spaces"));
  v("deadline", p.deadline,
    Number("s", "real time: time for each answer; after it, gravity compensation and damping act",
           From(5e-5, 9e-4)));
  v("real_time_priority", p.real_time_priority,
    Flag("real time: whether the program's process gets a real-time priority below the control "
         "loop's; it must then sleep while it waits for a request"));
}

class Process final : public ExternalController {
 public:
  Process(const ControllerContext& context, const ProcessParameters& parameters)
      : ExternalController(context),
        deadline_(parameters.deadline),
        wants_priority_(parameters.real_time_priority),
        process_(parameters.command, context.folder) {
    PredictorControllerMemory& shared = process_.shared();
    shared.input.dof = context.model.dof();
    shared.input.dt = context.period;
    std::copy_n(context.posture.data(), context.posture.size(), shared.posture);
    FillPose(context.X_WE_start, shared.X_WE_start);
    shared.gravity = context.gravity;
    WriteText(context, parameters);
    if (!process_.AskAndWait(PREDICTOR_CREATE, kStartTime)) Refuse(parameters, NoAnswer());
    if (shared.refused != 0) Refuse(parameters, "refuses this scenario. " + Said());
    // The value is read only once, because the program can change it at any time.
    const std::int32_t size = __atomic_load_n(&shared.memory_size, __ATOMIC_RELAXED);
    if (size < 0 || size > PREDICTOR_MAX_MEMORY)
      Refuse(parameters, "has a memory of " + std::to_string(size) +
                             " numbers; it must have from 0 to " +
                             std::to_string(PREDICTOR_MAX_MEMORY) + ".");
    uses_wrist_sensor_ = shared.uses_wrist_sensor != 0;
    memory_.resize(static_cast<std::size_t>(size));
  }

  std::span<double> memory() noexcept override { return memory_; }
  bool uses_wrist_sensor() const noexcept override { return uses_wrist_sensor_; }
  void SetRealTime(bool real_time) noexcept override { real_time_ = real_time; }
  std::string PrioritiseProcess(bool on) override {
    if (!wants_priority_) return "";
    const int error = process_.SetPriority(on ? kControllerPriority : 0);
    if (error == 0) return on ? "controller's process: granted (SCHED_FIFO 70)" : "";
    return std::string("controller's process: refused (") + std::strerror(error) +
           "), so its answers may be late";
  }
  void Start(const ControllerInput& input) noexcept override {
    must_start_ = !memory_.empty();
    TryStart(Fill(input));
  }
  void Advance(const ControllerInput& input, double) noexcept override {
    if (!memory_.empty() && TryStart(Fill(input)) && Request(PREDICTOR_ADVANCE, Fill(input)))
      TakeMemory();
  }
  // Returns the energy at the input of the last torques. A separate request for the energy would
  // take as long as a request for torques.
  double StoredEnergy(const ControllerInput&) const noexcept override { return energy_; }

 private:
  using Clock = std::chrono::steady_clock;

  double longest_silence() const noexcept override { return real_time_ ? kLongestSilence : 0; }

  Answer Ask(const PredictorControllerInput& input, double* torque) noexcept override {
    const Clock::time_point now = Clock::now();
    if (!TryStart(input) || !Request(PREDICTOR_COMPUTE, input)) {
      if (!silent_since_) silent_since_ = now;
      return {false, std::chrono::duration<double>(Clock::now() - *silent_since_).count()};
    }
    silent_since_.reset();
    const PredictorControllerMemory& shared = process_.shared();
    std::copy_n(shared.torque, input.dof, torque);
    double energy = 0;
    __atomic_load(&shared.stored_energy, &energy, __ATOMIC_RELAXED);
    if (IsUsable(energy)) energy_ = energy;
    return {};
  }

  // Repeats a start that the program could not answer. Without this start, the program's memory
  // would be that of the last run. Returns false as long as the program has not answered the
  // request to start.
  bool TryStart(const PredictorControllerInput& input) noexcept {
    if (!must_start_) return true;
    if (!Request(PREDICTOR_START, input)) return false;
    TakeMemory();
    must_start_ = false;
    return true;
  }

  bool Request(int kind, const PredictorControllerInput& input) noexcept {
    if (process_.IsBusy()) {
      // The shared memory belongs to the program at present. In virtual time, the emulator no
      // longer uses the program.
      return false;
    }
    PredictorControllerMemory& shared = process_.shared();
    shared.input = input;
    std::ranges::copy(memory_, shared.memory);
    return real_time_ ? process_.AskAndWatch(kind, deadline_)
                      : process_.AskAndWait(kind, kLongestWait);
  }

  // The program can change these numbers at any time. A number that is not finite would make every
  // later step invalid.
  void TakeMemory() noexcept {
    std::array<double, PREDICTOR_MAX_MEMORY> taken;
    std::copy_n(process_.shared().memory, memory_.size(), taken.begin());
    if (std::all_of(taken.begin(), taken.begin() + memory_.size(), IsUsable))
      std::copy_n(taken.begin(), memory_.size(), memory_.begin());
  }

  void WriteText(const ControllerContext& context, const ProcessParameters& given) {
    std::string text;
    for (const auto& [key, value] : InterfaceParameters(given.parameters))
      text.append(text.empty() ? "" : " ").append(key).append("=").append(value);
    for (int j = 0; j < context.model.dof(); ++j) text += "\n" + context.model.joint_name(j);
    if (text.size() >= PREDICTOR_TEXT_SIZE)
      throw InputError::At("cobot.controller.parameters",
                           "cobot.controller.parameters is too long. Give fewer parameters.");
    std::copy_n(text.c_str(), text.size() + 1, process_.shared().text);
  }

  std::string NoAnswer() {
    const std::string how = process_.HowItEnded();
    return how.empty() ? "did not answer within " + FormatNumber(kStartTime) +
                             " s of its start. Read what it printed."
                       : "ended before it answered (" + how + "). Read what it printed.";
  }
  std::string Said() {
    const char* text = process_.shared().text;
    return Printable({text, strnlen(text, PREDICTOR_TEXT_SIZE)});
  }
  [[noreturn]] static void Refuse(const ProcessParameters& given, const std::string& why) {
    throw InputError::At(
        "cobot.controller.command",
        "cobot.controller.command: " + Quote(Join(given.command, " ")) + " " + why);
  }

  const double deadline_;  // [s]
  const bool wants_priority_;
  ControllerProcess process_;
  std::vector<double> memory_;
  double energy_ = 0;  // [J]
  bool uses_wrist_sensor_ = false;
  bool real_time_ = false;
  bool must_start_ = false;                        // the program has not answered the last Start
  std::optional<Clock::time_point> silent_since_;  // the first question without an answer in time
};

}  // namespace

const ControllerKind kProcess = ControllerKindOf<Process, ProcessParameters>(
    "process", "your own program, in any language", ControllerPlace::kProcess);

}  // namespace predictor::controllers
