#include "scenario/machine.h"

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "scenario/field_reader.h"
#include "scenario/field_writer.h"
#include "scenario/located.h"

namespace predictor {

inline std::vector<std::string> NamesOf(ArmMake) { return {"ur", "franka"}; }
inline std::vector<std::string> NamesOf(SensorMake) { return {"own", "net_ft", "onrobot"}; }

namespace {

// The fastest that any machine may allow: hands must be able to follow [m/s].
constexpr double kMostHandleSpeed = 0.5;

}  // namespace

template <class V>
void Fields(V& v, CollisionThresholds& s) {
  v("force", s.force, Number("N", "from outside, at the stiffness frame", Above(0, 200)));
  v("torque", s.torque, Number("N·m", "from outside, at the stiffness frame", Above(0, 50)));
  v("joint_torque", s.joint_torque, Number("N·m", "from outside, of each joint", Above(0, 100)));
}

template <class V>
void Fields(V& v, EnablingInput& s) {
  v("arm", s.arm, Required(Word("whose controller it is wired to", {"left", "right"})));
  v("digital_input", s.digital_input,
    Required(
        Number("", "UR: 0 … 7 standard, 8 … 15 configurable, 16 and 17 the tool's", From(0, 17))));
}

template <class V>
void Fields(V& v, ArmConnection& s) {
  v("make", s.make, Required(Word("make of the arm")));
  v("host", s.host, Required(Word("address of its controller, as 192.0.2.10")));
  v("first_register", s.first_register,
    Number("", "UR: first RTDE register that we use: 0, or 24 where a fieldbus has those below",
           From(0, 24)));
  v("collision", s.collision,
    Part("Franka: what its own reflex stops it at; null: as the robot has it"));
}

template <class V>
void Fields(V& v, SensorConnection& s) {
  v("make", s.make, Word("own: what the arm itself measures"));
  v("host", s.host, Word("address of the sensor; own: none"));
  v("counts_per_force", s.counts_per_force,
    Number("1/N", "of the sensor's configuration (ATI: cfgcpf; OnRobot: 10000)", Above(0, 1e9)));
  v("counts_per_torque", s.counts_per_torque,
    Number("1/(N·m)", "the same of torque (ATI: cfgcpt; OnRobot: 100000)", Above(0, 1e9)));
}

template <class V>
void Fields(V& v, Commissioned& s) {
  v("push_test", s.push_test, Required(Word("when pushes read as they were pushed")));
  v("of", s.of, Required(Word("hash of the arm as it was then: after a change, test again")));
}

template <class V>
void Fields(V& v, MachineArm& s) {
  v("connection", s.connection, Part("how the arm is reached"));
  v("sensor", s.sensor, Part("how its force/torque sensor is reached"));
  v("arm", s.arm, Part("what is known of arm, sensor and handle: device.arms.* of a scenario"));
  v("commissioned", s.commissioned, Part("written by `predictor calibrate push`; null: never"));
}

template <class V>
void Fields(V& v, MachineLimits& s) {
  v("force", s.force, Number("N", "of a hand", Above(0, 200)));
  v("torque", s.torque, Number("N·m", "of a hand", Above(0, 50)));
  v("handle_speed", s.handle_speed, Number("m/s", "of a handle", Above(0, kMostHandleSpeed)));
  v("handle_rotation_speed", s.handle_rotation_speed, Number("rad/s", "of a handle", Above(0, 3)));
  v("stop_acceleration", s.stop_acceleration,
    Number("m/s²", "at the handles while stopping", Above(0, 10)));
  v("stop_jerk", s.stop_jerk, Number("m/s³", "at the handles while stopping", Above(0, 1000)));
  v("align_speed", s.align_speed, Number("m/s", "while aligning", Above(0, 0.1)));
}

template <class V>
void Fields(V& v, Machine& s) {
  Rule version = Required(Number("", "version of this format", From(1, 1)));
  version.steps = {1};
  v("predictor_machine", s.predictor_machine, version);
  v("name", s.name, Word("of the machine, for people"));
  v.Group("arms", "the arms that hold the real handles", [&](V& g) {
    g("left", s.left, Part("left arm; null: absent"));
    g("right", s.right, Part("right arm; null: absent"));
  });
  v("limits", s.limits, Part("what no scenario may exceed here"));
  v("enabling", s.enabling,
    Part("device that a person holds while the arms may move; null: a key at the console"));
}

namespace {

void CheckArm(const MachineArm& arm, const std::string& path, const YamlNode& root,
              Problems* problems) {
  const auto add = [&](const std::string& key, const std::string& sentence) {
    problems->Add(PlaceOf(path + key, root), path + key + " " + sentence);
  };
  const bool own = arm.sensor.make == SensorMake::kOwn;
  if (own != arm.sensor.host.empty())
    add(".sensor.host", own ? "is given, but the arm's own sensor has no address of its own. "
                              "Remove it, or name the sensor's make."
                            : "is missing. Give the address of the sensor.");
  if (!arm.arm.model.starts_with("package://"))
    add(".arm.model", "is " + Quote(arm.arm.model) +
                          "; a machine serves scenarios in many folders, so its models are named "
                          "as package://PACKAGE/... (roots: PREDICTOR_PACKAGE_PATH).");
  if (arm.connection.collision && arm.connection.make != ArmMake::kFranka)
    add(".connection.collision",
        "is a Franka's; a UR's force limits are set in its safety configuration. Remove it.");
  if (arm.connection.first_register != 0 && arm.connection.first_register != 24)
    add(".connection.first_register",
        "is " + std::to_string(arm.connection.first_register) + "; it must be 0 or 24.");
}

// What of it cannot be, as a sentence after its key; "" if it can.
std::string EnablingRefusal(const EnablingInput& enabling, const Machine& machine) {
  const std::optional<MachineArm>& arm = machine.arm(enabling.arm == kHandNames[0] ? 0 : 1);
  if (!arm) return " is the " + enabling.arm + " arm's, and the machine has none there.";
  if (arm->connection.make == ArmMake::kFranka)
    return " is a Franka's, and FCI tells nothing of its inputs. Its own enabling device stops "
           "that "
           "arm by itself (user stop), and this program then stops the other; for the program, "
           "wire "
           "one to a UR's digital input, or leave this out and hold a key at the console.";
  return "";
}

class Hash {
 public:
  void Add(const std::string& text) {
    for (const char c : text) Add(static_cast<unsigned char>(c));
    Add(0xff);  // no letter of UTF-8: ends a text
  }
  std::string ToString() const { return Formatted("%016llx", value_); }

 private:
  void Add(unsigned char byte) { value_ = (value_ ^ byte) * 0x100000001b3ULL; }
  unsigned long long value_ = 0xcbf29ce484222325ULL;
};

// Keys and values, not comments.
void AddTree(const YamlNode& node, Hash* hash) {
  hash->Add(node.key);
  hash->Add(node.text);
  for (const YamlNode& item : node.items) AddTree(item, hash);
  hash->Add(")");
}

struct Limit {
  const char* key;
  const char* unit;
  double scenario, machine;
};

void RefuseLooser(const Scenario& s, const MachineLimits& m) {
  for (const Limit& limit :
       {Limit{"force", "N", s.safety.force, m.force},
        {"torque", "N·m", s.safety.torque, m.torque},
        {"handle_speed", "m/s", s.safety.handle_speed, m.handle_speed},
        {"handle_rotation_speed", "rad/s", s.safety.handle_rotation_speed, m.handle_rotation_speed},
        {"stop_acceleration", "m/s²", s.safety.stop_acceleration, m.stop_acceleration},
        {"stop_jerk", "m/s³", s.safety.stop_jerk, m.stop_jerk},
        {"align_speed", "m/s", s.safety.align_speed, m.align_speed}}) {
    if (limit.scenario <= limit.machine) continue;
    const std::string key = std::string("safety.") + limit.key;
    throw Located(InputError::At(key, key + " is " + FormatNumber(limit.scenario) + " " +
                                          limit.unit + ", and this machine allows " +
                                          FormatNumber(limit.machine) + " " + limit.unit +
                                          " at most: a scenario may tighten its limits, never "
                                          "loosen them."),
                  s);
  }
}

}  // namespace

Machine ParseMachine(const std::string& text, const std::string& name) {
  YamlNode root = ParseYaml(text, name);
  if (root.kind != YamlNode::Kind::kMap)
    throw InputError(root.place.Text(), "a machine is a group of keys, and this is " +
                                            Describe(root) +
                                            ". Begin with \"predictor_machine: 1\".");
  Problems problems;
  auto machine = ReadStruct<Machine>(root, &problems);
  problems.ThrowIfAny();
  if (machine.left) CheckArm(*machine.left, "arms.left", root, &problems);
  if (machine.right) CheckArm(*machine.right, "arms.right", root, &problems);
  if (!machine.left && !machine.right)
    problems.Add(PlaceOf("arms", root), "arms is empty: a machine has one arm at least.");
  if (machine.enabling)
    if (const std::string why = EnablingRefusal(*machine.enabling, machine); !why.empty())
      problems.Add(PlaceOf("enabling.arm", root), "enabling.arm" + why);
  problems.ThrowIfAny();
  machine.file = name;
  machine.tree = std::make_shared<const YamlNode>(std::move(root));
  return machine;
}

Machine LoadMachine(const std::filesystem::path& file) {
  return ParseMachine(ReadYamlText(file, "a machine file"), file.string());
}

std::string SaveMachine(const Machine& machine) { return WriteYaml(WriteStruct(machine)); }

std::string HashOf(const MachineArm& arm) {
  MachineArm said = arm;
  said.commissioned.reset();
  Hash hash;
  AddTree(WriteStruct(said), &hash);
  return hash.ToString();
}

bool IsPushTested(const MachineArm& arm) {
  return arm.commissioned && arm.commissioned->of == HashOf(arm);
}

void RequirePushTests(const Machine& machine, const Scenario& scenario) {
  for (int hand = 0; hand < kHands; ++hand) {
    const std::optional<MachineArm>& arm = machine.arm(hand);
    if (!scenario.Has(hand) || !arm || IsPushTested(*arm)) continue;
    const std::string name = kHandNames[static_cast<std::size_t>(hand)];
    const bool changed = arm->commissioned.has_value();
    const std::string why =
        changed ? "was changed after its pushes were tested" : "has never had its pushes tested";
    std::string sentence = "arms.";
    sentence.append(name).append(" ").append(why);
    sentence +=
        ": a sensor that reads another way than the hand pushes would drive the arm against "
        "it. Run `predictor calibrate push --machine ";
    sentence.append(machine.file.string()).append(" --arm ").append(name).append("`.");
    throw InputError(machine.file.string(), sentence);
  }
}

void ApplyMachine(const Machine& machine, Scenario* scenario) {
  RefuseLooser(*scenario, machine.limits);
  scenario->device.type = "real";
  for (int hand = 0; hand < kHands; ++hand) {
    std::optional<ArmSpec>& arm = hand == 0 ? scenario->device.left : scenario->device.right;
    arm.reset();
    if (!scenario->Has(hand)) continue;
    const std::string name = kHandNames[static_cast<std::size_t>(hand)];
    const std::string key = "handles." + name;
    if (!machine.arm(hand)) {
      std::string sentence = key;
      sentence.append(" needs an arm, and the machine ").append(machine.file.string());
      sentence.append(" has none there. Give arms.").append(name);
      sentence += " in it, or remove the handle.";
      throw Located(InputError::At(key, sentence), *scenario);
    }
    arm = machine.arm(hand)->arm;
  }
}

}  // namespace predictor
