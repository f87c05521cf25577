// predictor init: writes a commented scenario that passes its check and runs unchanged, for one or
// two arms, a given cobot and an object. In the scenario, the object and the arms are placed
// relative to the cobot's end-effector.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/check/check.h"
#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "core/text.h"
#include "core/types.h"
#include "core/units.h"
#include "init_cobot.h"
#include "scenario/scenario_io.h"
#include "screen.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

// The masses of the object that `init` tries [kg]. A smaller mass leaves too little stability
// margin.
constexpr double kMasses[] = {9, 6};
constexpr double kDampingRatios[] = {1, 1.5, 2};
// The angles between the last link and straight down that `init` tries [rad].
constexpr double kTilts[] = {0, 30 / kDegrees, 60 / kDegrees, 90 / kDegrees};
// Position of the handles for a standing person: distance in front of the feet, and height above
// the ground [m].
constexpr double kHandsAhead = 0.45, kHandsHeight = 1.0;

// A scenario that `init` may write.
struct Draft {
  InitCobot cobot;
  double mass = 0;  // mass of the object [kg]
  double damping_ratio = 0;
  std::vector<std::string> problems;  // problems found by its check
};

struct Object {
  const char *name, *shape;
  PrimitiveSpec primitive;  // without its mass
  double half_height;       // height from the object's centre to the cobot above it [m]
  double handle_y;          // distance of the left and right handle from the centre [m]
  double handle_z;          // height of the handles above the centre [m]

  InitObject WithMass(double mass) const {
    InitObject object{primitive, half_height};
    object.primitive.mass = mass;
    return object;
  }
};

const Object& ObjectNamed(const std::string& name) {
  static const Object kObjects[] = {
      {"box", "box", {Shape::kBox, {0.3, 0.3, 0.2}}, 0.1, 0.12, -0.1},
      {"bar", "box", {Shape::kBox, {0.2, 0.5, 0.1}}, 0.05, 0.25, -0.05},
      {"ball", "sphere", {Shape::kSphere, {0.15, 0, 0}}, 0.15, 0.1, -0.1}};
  return *std::ranges::find_if(kObjects, [&](const Object& o) { return name == o.name; });
}

// Returns a word that a shell reads as `text`.
std::string ShellWord(const std::string& text) {
  const bool plain = text.find_first_not_of(
                         "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                         "0123456789_-./") == std::string::npos;
  if (plain) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

std::string List(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double value : values)  // without rounding errors of rotations
    words.push_back(Formatted("%.4g", std::abs(value) < 1e-9 ? 0 : value));
  return "[" + Join(words) + "]";
}
std::string List(const Vector3& p) { return List(std::vector<double>{p.x(), p.y(), p.z()}); }

// Returns the text of one arm with its base at `base` in the world [m].
std::string ArmText(const char* side, const Vector3& base) {
  return Formatted(
      "    %s:\n"
      "      model: %s\n"
      "      remove_links: [panda_hand]\n"
      "      base: {xyz: %s}  # in the world [m]\n"
      "      end_effector: panda_link8\n"
      "      handle: {xyz: [0, 0, 0.1], rpy: [3.14159265, 0, -0.78539816]}  # on the end-effector\n"
      "      posture: [0, -0.5, 0, -2.3, 0, 1.8, 0.785]  # first guess of the start [rad]\n"
      "      elbow: panda_link4\n",
      side, kPandaUrdf, List(base).c_str());
}

std::string CobotText(const InitOptions& o, const Draft& draft) {
  const InitCobot& cobot = draft.cobot;
  const std::string removed = cobot.remove_links.empty()
                                  ? ""
                                  : "  remove_links: [" + Join(cobot.remove_links) +
                                        "]  # with all that is attached to them\n";
  const std::string base =
      cobot.base_height == 0
          ? ""
          : Formatted("  base: {xyz: [0, 0, %g]}  # on a pedestal, above the floor [m]\n",
                      cobot.base_height);
  const std::string name = fs::path(o.name).filename(), file = ShellWord(o.name + ".yaml");
  return Formatted(
      "# %s: a scenario to start from. Check it with `predictor check %s`, run it with\n"
      "# `predictor run %s`. `predictor schema scenario` lists all keys.\n"
      "predictor: 1\n"
      "name: %s\n"
      "mode: emulate\n"
      "duration: 16  # [s]\n"
      "seed: 1\n"
      "\n"
      "# The simulated cobot.\n"
      "cobot:\n"
      "  model: %s\n%s%s"
      "  end_effector: %s  # link that holds the object\n"
      "  posture: %s  # at the start [rad]\n"
      "  joint_friction: {viscous: 1.0}\n"
      "  payload: {mass: %g, center_of_mass: %s}  # that it compensates [kg], [m]\n"
      "  controller:  # compliant sideways, stiff vertically, so that people can guide the object\n"
      "    type: cartesian_impedance\n"
      "    stiffness: {translation: [5, 5, 500], rotation: [100, 100, 100]}  # [N/m], [N·m/rad]\n"
      "    damping_ratio: %g\n"
      "\n",
      o.name.c_str(), file.c_str(), file.c_str(), nlohmann::json(name).dump().c_str(),
      cobot.model.c_str(), removed.c_str(), base.c_str(), cobot.end_effector.c_str(),
      List(cobot.posture).c_str(), draft.mass, List(cobot.attachment).c_str(), draft.damping_ratio);
}

std::string ObjectText(const InitOptions& o, const Draft& draft) {
  const Pose& X_WE = draft.cobot.X_WE;
  const Object& object = ObjectNamed(o.object);
  std::string text = Formatted(
      "# The object that the cobot holds from above, and the handles that people hold.\n"
      "object:\n"
      "  primitive: {shape: %s, size: %s, mass: %g}  # [m], [kg]\n"
      "  attachment:\n"
      "    joint: spherical\n"
      "    damping: 0.1  # of the ball joint [N·m·s/rad]\n"
      "    on_end_effector: {xyz: %s, rpy: %s}\n"
      "    on_object: {xyz: [0, 0, %.4g]}\n\n"
      "handles:  # on the object [m]\n",
      object.shape, List(object.primitive.size).c_str(), draft.mass,
      List(draft.cobot.attachment).c_str(), List(RpyOf(X_WE.q.conjugate())).c_str(),
      object.half_height);
  if (o.arms == 1) return text + Formatted("  left: {xyz: [0, 0, %.4g]}\n\n", object.handle_z);
  Append(&text, "  left: {xyz: [0, -%.4g, %.4g]}\n  right: {xyz: [0, %.4g, %.4g]}\n\n",
         object.handle_y, object.handle_z, object.handle_y, object.handle_z);
  return text;
}

std::string DeviceText(const InitOptions& o, const InitCobot& cobot) {
  const InitCobot panda = PandaCobot();
  const Vector3 shift = cobot.X_WE * cobot.attachment - panda.X_WE * panda.attachment;
  std::string text =
      "# The haptic arms; here they are simulated. Real ones: predictor run SCENARIO --machine "
      "FILE\n"
      "device:\n"
      "  type: simulated\n"
      "  arms:\n";
  if (o.arms == 1) return text + ArmText("left", shift + Vector3(0.15, 0, -0.15)) + "\n";
  const double y = 0.13 + ObjectNamed(o.object).handle_y;
  return text + ArmText("left", shift + Vector3(0.1, -y, -0.25)) +
         ArmText("right", shift + Vector3(0.1, y, -0.25)) + "\n";
}

std::string OperatorText(const InitOptions& o, const Draft& draft) {
  const Object& object = ObjectNamed(o.object);
  Vector3 ground = draft.cobot.ObjectAt(object.WithMass(draft.mass));
  ground += Vector3(kHandsAhead, 0, object.handle_z - kHandsHeight);
  return Formatted(
      "# A simulated operator. To guide the object yourself, replace this section by `type: "
      "browser`\n"
      "# and take the operator's hands in the viewer.\n"
      "operator:\n"
      "  type: virtual\n"
      "  # Examples for `predictor evaluate`: who the operator is, and where the operator stands.\n"
      "  body: {height: 1.75, mass: 75, sex: female}  # [m], [kg]\n"
      "  stance: {ground: [%.2f, %.2f, %.2f], facing: 180 deg}  # midway between the feet [m]\n"
      "  script:\n"
      "    - {action: grip, start: 0, duration: 0.5}\n"
      "    - {action: move, start: 1, duration: 3, by: [0, 0, 0.05]}\n"
      "    - {action: move, start: 4, duration: 4, by: [0, 0.08, 0]}\n"
      "    - {action: move, start: 8, duration: 4, by: [0, -0.08, 0]}\n"
      "    - {action: put_down, start: 12, duration: 3, by: [0, 0, -0.05]}\n",
      ground.x(), ground.y(), ground.z());
}

std::string TextOf(const InitOptions& o, const Draft& draft) {
  return CobotText(o, draft) + ObjectText(o, draft) + DeviceText(o, draft.cobot) +
         OperatorText(o, draft);
}

// Returns the reasons for which the scenario `text` would be refused or would fail its check. One
// such reason is an object that the floor carries or that overlaps the cobot.
std::vector<std::string> ProblemsOf(const std::string& text, const fs::path& file) {
  try {
    CheckOptions how;
    how.search = false;
    const CheckReport report =
        Check(ParseScenario(text, file.string(), fs::absolute(file).parent_path()), how);
    std::vector<std::string> problems = report.problems;
    std::ranges::move(StartWarnings(report.start), std::back_inserter(problems));
    return problems;
  } catch (const InputError& error) {
    return {error.what()};
  }
}

// Returns the first draft that passes its check. If no draft passes, returns the first draft with
// its problems. If there is no draft, returns nothing. `tilt` is passed to OwnCobots.
std::optional<Draft> ChooseAt(double tilt, const InitOptions& o, const fs::path& file) {
  std::optional<Draft> first;
  for (const double mass : kMasses) {
    const InitObject object = ObjectNamed(o.object).WithMass(mass);
    const std::vector<InitCobot> cobots =
        o.urdf.empty() ? std::vector{PandaCobot()}
                       : OwnCobots(o.urdf, o.end_effector, file, object, tilt);
    for (const InitCobot& cobot : cobots)
      for (const double damping_ratio : kDampingRatios) {
        Draft draft{cobot, mass, damping_ratio, {}};
        draft.problems = ProblemsOf(TextOf(o, draft), file);
        if (draft.problems.empty()) return draft;
        if (!first) first = draft;
      }
  }
  return first;
}

Draft Choose(const InitOptions& o, const fs::path& file) {
  for (const double tilt : kTilts)
    if (std::optional<Draft> draft = ChooseAt(tilt, o, file)) return *draft;
  throw InputError(
      o.urdf,
      Formatted(
          "The lightest object that leaves enough stability margin weighs %g kg. No posture "
          "was found in which this robot's arm can carry such an object clear of the arm's "
          "links and with the last link pointing horizontally or down. Check the effort "
          "limits of the robot's joints, or choose the link that holds the object: --end-effector "
          "LINK. If this is a small robot, see docs/tutorials/own-cobot.md, \"A small cobot\".",
          *std::ranges::min_element(kMasses)));
}

std::string JsonOf(const Draft& draft, const std::string& file) {
  const InitCobot& cobot = draft.cobot;
  const nlohmann::ordered_json result = {{"file", file},
                                         {"model", cobot.model},
                                         {"end_effector", cobot.end_effector},
                                         {"posture", cobot.posture},
                                         {"base_height_m", cobot.base_height},
                                         {"tilt_rad", cobot.tilt},
                                         {"removed_links", cobot.remove_links},
                                         {"removed_mass_kg", cobot.removed_mass},
                                         {"object_mass_kg", draft.mass},
                                         {"damping_ratio", draft.damping_ratio},
                                         {"fit", draft.problems.empty()},
                                         {"problems", draft.problems}};
  return result.dump(2) + "\n";
}

std::string ResultText(const InitOptions& o, const Draft& draft, const std::string& file) {
  const InitCobot& cobot = draft.cobot;
  std::string text;
  if (!o.urdf.empty())
    text = Formatted("The link %s, which %zu joints move, holds the object of %g kg.\n",
                     cobot.end_effector.c_str(), cobot.posture.size(), draft.mass);
  if (!o.urdf.empty() && !cobot.remove_links.empty())
    Append(&text,
           "The scenario leaves out these links (%.2g kg), because other joints move them: %s. To "
           "choose another link for the object, use --end-effector.\n",
           cobot.removed_mass, Join(cobot.remove_links).c_str());
  if (cobot.base_height > 0)
    Append(&text,
           "If the base stood on the floor, the cobot could not hold the object freely with its "
           "last link pointing down. The base is therefore %g m above the floor.\n",
           cobot.base_height);
  if (cobot.tilt > 0)
    Append(&text,
           "No posture was found in which the last link points straight down: the link leans away "
           "from the base by %.0f°.\n",
           kDegrees * cobot.tilt);
  if (!draft.problems.empty()) return text + "Wrote " + file + ", which does not pass its check.\n";
  const std::string word = ShellWord(file);
  return text + "Wrote " + file + ". Next: predictor check " + word + "; predictor run " + word +
         "\n";
}

}  // namespace

int InitCommand(const InitOptions& given) {
  InitOptions options = given;
  for (const char* ending : {".yaml", ".yml"})
    if (options.name.ends_with(ending))
      options.name.resize(options.name.size() - std::strlen(ending));
  const std::string file = options.name + ".yaml";
  if (fs::path(options.name).filename().empty() || Printable(options.name) != options.name)
    throw InputError("The name " + Quote(options.name) +
                     " cannot be the name of a file. Give the scenario a name of letters, digits, "
                     "- or _, for example first.");
  options.CheckWritable();
  options.RefuseToReplace(file);
  if (options.urdf.empty() && !options.end_effector.empty())
    throw InputError(
        "--end-effector names a link of your own cobot. Also give the URDF of this cobot with "
        "--urdf FILE.");
  const Draft draft = Choose(options, file);
  WriteWholeFile(file, TextOf(options, draft));
  for (const std::string& problem : draft.problems) TheScreen().Print("Unfit: " + problem);
  options.Write(ResultText(options, draft, file), JsonOf(draft, file));
  return draft.problems.empty() ? kFinished : kUnfit;
}

}  // namespace predictor
