#include "scenario/machine.h"

#include <arpa/inet.h>

#include <cinttypes>
#include <utility>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "scenario/field_reader.h"
#include "scenario/field_writer.h"
#include "scenario/located.h"
#include "scenario/machine_fields.h"
#include "scenario/stop_budget.h"

namespace predictor {

namespace {

// Returns whether an address is invalid, such as 300.1.1.1, 192.0.2 or one with a port. Host names
// are resolved.
bool IsNoAddress(const std::string& host) {
  in_addr address{};
  if (host.find_first_of(":/ ") != std::string::npos) return true;
  return host.find_first_not_of("0123456789.") == std::string::npos &&
         inet_pton(AF_INET, host.c_str(), &address) != 1;
}

void CheckArm(const MachineArm& arm, const std::string& path, const YamlNode& root,
              Problems* problems) {
  const auto add = [&](const std::string& key, const std::string& sentence) {
    problems->Add(PlaceOf(path + key, root), path + key + " " + sentence);
  };
  const bool own = arm.sensor.make == SensorMake::kOwn;
  if (own != arm.sensor.host.empty())
    add(".sensor.host", own ? "is given, but the arm's own sensor has no separate address. Remove "
                              "this key, or set the sensor's make."
                            : "is missing. Give the address of the sensor.");
  for (const auto& [key, host] :
       {std::pair{".connection.host", &arm.connection.host}, {".sensor.host", &arm.sensor.host}})
    if (!(own && host == &arm.sensor.host) && !host->empty() && IsNoAddress(*host))
      add(key, "is " + Quote(*host) +
                   ", which is not an IPv4 address. Write four numbers from 0 to " +
                   "255 without a port, for example 192.0.2.10.");
  if (!arm.arm.model.starts_with("package://"))
    add(".arm.model", "is " + Quote(arm.arm.model) +
                          ". Write the model as package://PACKAGE/..., because a machine file is "
                          "used with scenarios in many folders (roots: PREDICTOR_PACKAGE_PATH).");
  const Vector3& inertia = arm.arm.payload.inertia;
  if (inertia.maxCoeff() > (inertia.sum() - inertia.maxCoeff()) * (1 + 1e-12))
    add(".arm.payload.inertia",
        "is physically impossible: the largest moment must be at most the sum of the two others. "
        "Measure the handle again.");
  // The limits for the values that determine when samples are stale and when readings are frozen.
  constexpr double kMinRate = 125;  // [Hz]
  for (const auto& [key, rate] : {std::pair{".arm.sample_rate", arm.arm.sample_rate},
                                  {".arm.sensor.sample_rate", arm.arm.sensor.sample_rate}})
    if (!(rate >= kMinRate))
      add(key, "is " + FormatNumber(rate) + " Hz; real arms need " + FormatNumber(kMinRate) +
                   " Hz or more, so that a silent device is detected within 20 ms.");
  const auto check_noise = [&](const char* key, double noise, double most, const char* unit) {
    if (!(noise <= most))
      add(key, "is " + FormatNumber(noise) + unit + "; a sensor of more than " +
                   FormatNumber(most) + unit +
                   " of noise cannot measure a hand. Measure the noise at rest.");
  };
  check_noise(".arm.sensor.noise_force", arm.arm.sensor.noise_force, 5, " N");
  check_noise(".arm.sensor.noise_torque", arm.arm.sensor.noise_torque, 0.5, " N·m");
  if (arm.connection.collision && arm.connection.make != ArmMake::kFranka)
    add(".connection.collision",
        "applies to a Franka only. Set a UR's force limits in its safety configuration, and remove "
        "this key.");
  if (arm.connection.first_register != 0 && arm.connection.first_register != 24)
    add(".connection.first_register",
        "is " + std::to_string(arm.connection.first_register) + "; it must be 0 or 24.");
}

// Returns the error in the enabling input as the end of a sentence that begins with the key, or ""
// if there is no error.
std::string EnablingRefusal(const EnablingInput& enabling, const Machine& machine) {
  const std::optional<MachineArm>& arm = machine.arm(enabling.arm == kHandNames[0] ? 0 : 1);
  if (!arm) return " is the " + enabling.arm + " arm, but the machine has no such arm.";
  if (arm->connection.make == ArmMake::kFranka)
    return " is a Franka, but FCI does not report its inputs. Wire the enabling device to a "
           "digital input of a UR, or remove this key and hold a key at the console. The Franka's "
           "own enabling device stops that arm directly (user stop), and this program then stops "
           "the other arm.";
  return "";
}

// Computes a hash of keys and values without the comments. The byte 0xff ends each text, because it
// never occurs in UTF-8.
void AddTree(const YamlNode& node, std::uint64_t* hash) {
  for (const std::string& text : {node.key, node.text}) *hash = Fnv1a(text + '\xff', *hash);
  for (const YamlNode& item : node.items) AddTree(item, hash);
  *hash = Fnv1a(")\xff", *hash);
}

}  // namespace

Machine ParseMachine(const std::string& text, const std::string& name) {
  YamlNode root = ParseYaml(text, name);
  if (root.kind != YamlNode::Kind::kMap)
    throw InputError(root.place.Text(), "a machine file must be a group of keys, but this is " +
                                            Describe(root) +
                                            ". Begin with \"predictor_machine: 1\".");
  Problems problems;
  auto machine = ReadStruct<Machine>(root, &problems);
  problems.ThrowIfAny();
  if (machine.left) CheckArm(*machine.left, "arms.left", root, &problems);
  if (machine.right) CheckArm(*machine.right, "arms.right", root, &problems);
  if (!machine.left && !machine.right)
    problems.Add(PlaceOf("arms", root), "arms is empty. A machine needs at least one arm.");
  if (machine.left && machine.right &&
      machine.left->connection.host == machine.right->connection.host)
    problems.Add(PlaceOf("arms.right.connection.host", root),
                 "arms.right.connection.host is also the address of the left arm. Give each arm "
                 "its own address.");
  if (machine.left && machine.right && !machine.left->sensor.host.empty() &&
      machine.left->sensor.host == machine.right->sensor.host)
    problems.Add(PlaceOf("arms.right.sensor.host", root),
                 "arms.right.sensor.host is also the address of the left sensor, but one sensor "
                 "cannot measure both hands. Give each sensor its own address.");
  for (int hand = 0; hand < kHands && machine.left && machine.right; ++hand)
    if (machine.arm(hand)->arm.elbow.empty()) {
      const std::string key = "arms." + std::string(HandName(hand)) + ".arm.elbow";
      problems.Add(
          PlaceOf(key, root),
          key +
              " is missing. Give the link that must keep its distance from the other arm's elbow.");
    }
  if (machine.enabling)
    if (const std::string why = EnablingRefusal(*machine.enabling, machine); !why.empty())
      problems.Add(PlaceOf("enabling.arm", root), "enabling.arm" + why);
  if (const std::string why = StopRefusal(machine.limits.stop_acceleration,
                                          machine.limits.stop_jerk, machine.limits.handle_speed);
      !why.empty())
    problems.Add(PlaceOf("limits", root), "limits.stop_acceleration and limits.stop_jerk " + why);
  problems.ThrowIfAny();
  machine.file = name;
  machine.tree = std::make_shared<const YamlNode>(std::move(root));
  return machine;
}

Machine LoadMachine(const std::filesystem::path& file) {
  return ParseMachine(ReadYamlText(file, "a machine file"), file.string());
}

std::string SaveMachine(const Machine& machine) { return WriteYaml(WriteStruct(machine)); }

InputError Located(const InputError& error, const Machine& machine) {
  if (error.key().empty() || !machine.tree) return error;
  return {PlaceOf(error.key(), *machine.tree).Text(), error.what()};
}

std::string HashOf(const MachineArm& arm) {
  MachineArm said = arm;
  said.commissioned.reset();
  std::uint64_t hash = Fnv1a("");
  AddTree(WriteStruct(said), &hash);
  return Formatted("%016" PRIx64, hash);
}

bool IsPushTested(const MachineArm& arm) {
  return arm.commissioned && arm.commissioned->of == HashOf(arm);
}

std::string HashOfLoop(const MachineArm& arm) {
  MachineArm measured;
  measured.connection.make = arm.connection.make;
  measured.connection.host = arm.connection.host;
  measured.arm.loop = arm.arm.loop;
  return HashOf(measured);
}

bool IsLoopMeasured(const MachineArm& arm) {
  return arm.commissioned && arm.commissioned->loop_of == HashOfLoop(arm);
}

}  // namespace predictor
