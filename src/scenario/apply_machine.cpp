// Applies a machine to a scenario.
#include <map>
#include <set>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "scenario/located.h"
#include "scenario/machine_fields.h"
#include "scenario/stop_budget.h"
#include "scenario/yaml_tree.h"

namespace predictor {
namespace {

// The numbers in a field table, in the order of the table, without the numbers in the table's
// groups.
struct Numbers {
  struct Number {
    std::string key;
    double value;
    std::string unit;
  };
  std::vector<Number> list;

  template <class T>
  void operator()(const char* key, const T& member, const Rule& rule) {
    if constexpr (std::is_arithmetic_v<T>)
      list.push_back({key, static_cast<double>(member), rule.unit});
  }
  void Group(const char*, const char*, const auto&) {}
};

template <class Spec>
std::vector<Numbers::Number> NumbersOf(Spec spec) {
  Numbers numbers;
  Fields(numbers, spec);
  return numbers.list;
}

// Returns the message which states that the scenario's value `key` is looser than the machine's
// limit.
std::string LooserThan(const Numbers::Number& limit, const std::string& key, double value,
                       bool least, const std::filesystem::path& machine) {
  const std::string unit = limit.unit.empty() ? "" : " " + limit.unit;
  return key + " is " + FormatNumber(value) + unit + ", but this machine requires " +
         FormatNumber(limit.value) + unit + (least ? " at least" : " at most") + " (limits." +
         limit.key + " of " + machine.string() +
         "). A scenario can tighten the limits of the machine but not loosen them. Set " + key +
         " to " + FormatNumber(limit.value) + ".";
}

// Throws InputError if a value of the scenario is looser than the machine's limit. Each limit has
// the same name as a value in the scenario's safety or rendering group.
void RefuseLooser(const Machine& machine, const Scenario& s) {
  static const std::set<std::string> kMinima = {"stop_acceleration", "stop_jerk",
                                                "security_distance", "joint_security"};
  std::map<std::string, std::pair<std::string, double>> values;  // by limit name: key and value
  for (const auto& number : NumbersOf(s.safety))
    values[number.key] = {"safety." + number.key, number.value};
  for (const auto& number : NumbersOf(s.rendering))
    values.insert({number.key, {"rendering." + number.key, number.value}});
  for (const Numbers::Number& limit : NumbersOf(machine.limits)) {
    const auto& [key, value] = values.at(limit.key);
    const bool least = kMinima.contains(limit.key);
    if (least ? value >= limit.value : value <= limit.value) continue;
    throw Located(InputError::At(key, LooserThan(limit, key, value, least, machine.file)), s);
  }
}

[[noreturn]] void Refuse(const Scenario& s, const std::string& key, const std::string& sentence) {
  throw Located(InputError::At(key, key + " " + sentence), s);
}

// The lateness of samples and of ticks is measured in ticks, and the watchdog trips only after
// several late ticks. If the ticks were longer, a stop would start later than its time budget
// allows.
void RequireRate(const Scenario& s) {
  constexpr double kRate = 1000;  // [Hz]
  if (s.rate != kRate)
    Refuse(s, "rate",
           "is " + FormatNumber(s.rate) + " Hz, but real arms need a rate of " +
               FormatNumber(kRate) +
               " Hz, because slower ticks would delay a stop. Remove this key.");
}

// A large weight moves the handles away from their targets. It also moves the elbows, which no one
// monitors.
void RequireLittleManipulability(const Scenario& s) {
  constexpr double kMaxManipulability = 0.01;
  if (s.rendering.manipulability > kMaxManipulability)
    Refuse(s, "rendering.manipulability",
           "is " + FormatNumber(s.rendering.manipulability) + "; with real arms it must be " +
               FormatNumber(kMaxManipulability) +
               " or less, because a larger value moves the handles away from their targets.");
}

// No machine may loosen the detection of growing oscillations.
void RequireOscillationDetector(const Scenario& s) {
  const OscillationSpec& has = s.safety.oscillation;
  const std::string path = "safety.oscillation.";
  if (!has.enabled)
    Refuse(s, path + "enabled",
           "is false, but real arms that start to oscillate must be stopped. Remove this key.");
  const OscillationSpec all;
  struct Bound {
    const char* key;
    double value, bound;
    bool least;
  };
  // A filter band that starts much lower needs more time to settle after a change of the held
  // force. In this time, the detector finds no oscillation.
  for (const Bound& b :
       {Bound{"low", has.low, all.low, false},
        {"low", has.low, all.low / 2, true},
        {"high", has.high, all.high, true},
        {"cycles", static_cast<double>(has.cycles), static_cast<double>(all.cycles), false},
        {"amplitude", has.amplitude, all.amplitude, false}})
    if (b.least ? b.value < b.bound : b.value > b.bound)
      Refuse(s, path + b.key,
             "is " + FormatNumber(b.value) + "; with real arms it must be " +
                 FormatNumber(b.bound) + (b.least ? " at least" : " at most") +
                 ", so that oscillations are detected in time. Remove this key.");
}

// Stores the machine, so that errors of the machine's arms are reported with their places in the
// machine file (located.h).
void RememberMachine(const Machine& machine, Scenario* scenario) {
  if (!scenario->tree || !machine.tree) return;
  YamlNode tree = *scenario->tree;
  YamlNode& grafted = tree.items.emplace_back(*machine.tree);
  grafted.key = kMachineKey;
  scenario->tree = std::make_shared<const YamlNode>(std::move(tree));
}

// Returns one line for each arm of the scenario for which `is_done` returns false. The line
// contains the name of the arm, `not_done` and the remedy.
std::vector<std::string> LeftToDo(const Machine& machine, const Scenario& scenario,
                                  const char* step, bool (*is_done)(const MachineArm&),
                                  std::string (*not_done)(const std::string&, const MachineArm&)) {
  std::vector<std::string> lines;
  for (int hand = 0; hand < kHands; ++hand) {
    const std::optional<MachineArm>& arm = machine.arm(hand);
    if (!scenario.Has(hand) || !arm || is_done(*arm)) continue;
    const std::string name = HandName(hand);
    std::string line = not_done("arms." + name, *arm);
    line.append(" Run `predictor calibrate ").append(step).append(" --machine ");
    line.append(machine.file.string()).append(" --arm ").append(name).append("`.");
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

std::vector<std::string> UnmeasuredLoops(const Machine& machine, const Scenario& scenario) {
  return LeftToDo(
      machine, scenario, "loop", IsLoopMeasured, [](const std::string& arm, const MachineArm& of) {
        const bool was = of.commissioned && !of.commissioned->loop.empty();
        return "The velocity loop of " + arm + " was not measured" +
               (was ? " with its present settings" : "") +
               ". Without this measurement, there is no lag compensation, the stability margin is "
               "smaller, and the stopping distance is based on an assumed lag.";
      });
}

std::vector<std::string> UntestedPushes(const Machine& machine, const Scenario& scenario) {
  return LeftToDo(
      machine, scenario, "push", IsPushTested, [](const std::string& arm, const MachineArm& of) {
        const bool was = of.commissioned && !of.commissioned->of.empty();
        return arm + (was ? " was changed after its push test" : " has not passed a push test") +
               ", so `predictor run` does not start. A sensor with wrong axes would drive the arm "
               "against the hand.";
      });
}

void RequirePushTests(const Machine& machine, const Scenario& scenario) {
  std::string text;
  for (const std::string& line : UntestedPushes(machine, scenario))
    text += (text.empty() ? "" : "\n") + line;
  if (text.empty()) return;
  if (!UnmeasuredLoops(machine, scenario).empty())
    text +=
        "\n"
        "First measure the loops that are not measured yet (`predictor calibrate loop`), because "
        "any change of an arm requires a new push test.";
  throw InputError(machine.file.string(), text);
}

// A scenario cannot know where the ground of a laboratory is. A wrong height would falsify every
// judgement of the person's posture.
void StandOnGround(const Machine& machine, Scenario* scenario) {
  std::optional<StanceSpec>& stance = scenario->operator_.stance;
  const std::optional<PoseSpec>& shift = scenario->environment.shift;
  if (!machine.ground) stance.reset();
  if (stance) stance->ground.z() = *machine.ground - (shift ? shift->xyz.z() : 0);
}

void ApplyMachine(const Machine& machine, Scenario* scenario) {
  if (scenario->mode == Mode::kDirect)
    Refuse(*scenario, "mode",
           "is direct, which does not use the arms. Run the scenario without --machine, or set "
           "mode: emulate.");
  RefuseLooser(machine, *scenario);
  RequireRate(*scenario);
  RequireLittleManipulability(*scenario);
  RequireOscillationDetector(*scenario);
  if (const std::string why =
          StopRefusal(scenario->safety.stop_acceleration, scenario->safety.stop_jerk,
                      scenario->safety.handle_speed);
      !why.empty())
    Refuse(*scenario, "safety.stop_acceleration", "and safety.stop_jerk " + why);
  scenario->device.type = "real";
  StandOnGround(machine, scenario);
  for (int hand = 0; hand < kHands; ++hand) {
    std::optional<ArmSpec>& arm = hand == 0 ? scenario->device.left : scenario->device.right;
    arm.reset();
    if (!scenario->Has(hand)) continue;
    const std::string name = HandName(hand);
    const std::string key = "handles." + name;
    if (!machine.arm(hand)) {
      std::string sentence = key;
      sentence.append(" needs an arm, but the machine ").append(machine.file.string());
      sentence.append(" has none on that side. Add arms.").append(name);
      sentence += " to it, or remove the handle.";
      throw Located(InputError::At(key, sentence), *scenario);
    }
    arm = machine.arm(hand)->arm;
    if (machine.arm(hand)->connection.make == ArmMake::kFranka) arm->follows_position = true;
  }
  if (!UnmeasuredLoops(machine, *scenario).empty()) scenario->rendering.lead = 0;
  RememberMachine(machine, scenario);
}

}  // namespace predictor
