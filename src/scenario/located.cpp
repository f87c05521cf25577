#include "scenario/located.h"

#include "core/messages.h"
#include "scenario/yaml_tree.h"

namespace predictor {

std::string DeviceArmKey(int hand) { return std::string("device.arms.") + HandName(hand); }

std::string ArmKey(const Scenario& scenario, int hand) {
  const std::string name = HandName(hand);
  const bool on_machine = scenario.tree && scenario.tree->Find(kMachineKey);
  return on_machine ? "arms." + name + ".arm" : DeviceArmKey(hand);
}

std::string PlacementRemedy(const Scenario& scenario, int hand) {
  return scenario.HasFixedArms() ? "change environment.shift"
                                 : "move " + ArmKey(scenario, hand) + ".base";
}

InputError Located(const InputError& error, const Scenario& scenario) {
  if (error.key().empty() || scenario.tree == nullptr) return error;
  const YamlNode* machine = scenario.tree->Find(kMachineKey);
  for (int hand = 0; machine && hand < kHands; ++hand) {
    const std::string group = DeviceArmKey(hand);
    if (!error.key().starts_with(group)) continue;
    const std::string key = ArmKey(scenario, hand) + error.key().substr(group.size());
    const std::string sentence = error.what();  // starts with the key
    return {PlaceOf(key, *machine).Text(), sentence.starts_with(error.key())
                                               ? key + sentence.substr(error.key().size())
                                               : sentence};
  }
  return {PlaceOf(error.key(), *scenario.tree).Text(), error.what()};
}

}  // namespace predictor
