#include "real_arms.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <cstdio>

#include "core/error.h"
#include "core/format.h"
#include "core/real_time.h"
#include "devices/wire/network.h"
#include "haptics/stability.h"
#include "models/arm_model.h"
#include "scenario/located.h"
#include "scenario/scenario.h"
#include "simulation/world.h"

namespace predictor {
namespace {

// The function also parses the address, because a host name may begin with "127.", too.
bool IsLoopback(const std::string& host) {
  in_addr address{};
  return host == "localhost" ||
         (host.starts_with("127.") && inet_pton(AF_INET, host.c_str(), &address) == 1);
}

// Returns whether all addresses belong to this computer, which means that all devices of the
// machine are fakes.
bool OnThisComputer(const Machine& machine) {
  for (const std::optional<MachineArm>* arm : {&machine.left, &machine.right}) {
    if (!*arm) continue;
    for (const std::string& host : {(*arm)->connection.host, (*arm)->sensor.host})
      if (!host.empty() && !IsLoopback(host)) return false;
  }
  return true;
}

}  // namespace

ArmModels LoadArmModels(const Machine& machine) try {
  ArmModels models;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (const std::optional<MachineArm>& side = machine.arm(static_cast<int>(i)))
      models[i] = LoadArmModel(side->arm, side->arm.base.X_RB(), {},
                               std::string("arms.") + kHandNames[i] + ".arm");
  }
  return models;
} catch (const InputError& error) {
  throw Located(error, machine);
}

void RequireRealTime(const Machine& machine) {
  const RealTimeScheduling now;
  if (now.prior()) return;
  if (!OnThisComputer(machine))
    throw DeviceError("The real arms were not moved, because real-time scheduling was " +
                      now.got() + ". Then start again.");
  std::fprintf(stderr,
               "Warning: real-time scheduling was %s. If the arms were real, the program would "
               "refuse to start.\n",
               now.got().c_str());
}

void RequireStability(const Machine& machine, const Scenario& scenario) try {
  const World world(scenario);
  const double dt = 1 / scenario.rate;
  const double margin =
      ChooseLead(HapticLoop(world.Linearise(), scenario, dt), scenario, dt).margin.gain;
  if (margin >= 1) return;
  const std::string way = UnmeasuredLoops(machine, scenario).empty()
                              ? "`predictor check " + scenario.file.string() + " --machine " +
                                    machine.file.string() +
                                    " --set operator.type=person` shows remedies."
                              : "Measure the arms' velocity loops first, as described above. Lag "
                                "compensation then becomes available.";
  throw InputError(
      scenario.file.string(),
      Formatted(
          "the real arms were not moved, because the loop of hand, simulation and arms would be "
          "unstable. The stability margin is %.1f; at least 1 is required, and 2 is recommended. ",
          margin) +
          way);
} catch (const InputError& error) {
  throw Located(error, scenario);
}

void ConfirmPerturbation(const Scenario& scenario) {
  if (!scenario.perturbation) return;
  const PerturbationSpec& p = *scenario.perturbation;
  const std::string question = Formatted(
      "To identify the operator's arms, the handles will repeatedly move by themselves by up to "
      "%.0f mm during the run. A hand that resists with more than %.0f N ends such a motion. "
      "Does the person who will hold the handles know this and agree? Type yes to continue: ",
      1e3 * p.amplitude, p.force);
  std::fputs(question.c_str(), stderr);
  std::string answer;
  // The loop reads single characters, so that keys that are meant for the run are not lost.
  for (char c = 0; answer.size() < 16 && read(STDIN_FILENO, &c, 1) == 1 && c != '\n';) answer += c;
  if (answer == "yes") return;
  throw Located(InputError::At("perturbation.consent",
                               "The person's consent to displacements of the handles was not "
                               "confirmed, so the arms were not moved. Type yes, or set "
                               "perturbation: null."),
                scenario);
}

}  // namespace predictor
