#include "analysis/hazard_study/hazard_study.h"

#include <algorithm>
#include <atomic>
#include <memory>

#include "analysis/hazard_study/run_store.h"
#include "analysis/json_line_store.h"
#include "analysis/parallel.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "emulator/stop_reach.h"
#include "models/object_model.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

// The hazard begins at a random time in this window, so that an operator cannot anticipate it.
constexpr double kAfter = 2, kWindow = 2;  // [s]
// The limits of a cobot for which the scenario states none. They are a design choice, and wide
// enough for every undisturbed run.
constexpr double kForce = 100;       // [N]
constexpr double kSpeed = 0.75;      // [m/s]
constexpr double kJointTorque = 60;  // [N·m]

constexpr const char* kOwnController = "own";
constexpr const char* kLoadSharing = "load_sharing";
constexpr const char* kSlips = "object_slips";
constexpr double kGripShare = 0.5;  // share of the object's weight that the grip can hold; a design
                                    // choice

std::vector<std::string> Controller(const std::string& parameters) {
  return {"cobot.controller={" + parameters + "}"};
}

StudyChoice Hazard(const std::string& name, const std::string& parameters = "") {
  const std::string trigger = Formatted("trigger: {after: %g, window: %g}", kAfter, kWindow);
  return {name, {"events=[{event: " + name + ", " + trigger + parameters + "}]"}};
}

void SetSafety(CobotSafetySpec* safety) {
  const CobotSafetySpec& own = *safety;
  if (own.force || own.speed || own.momentum || own.joint_torque || own.joint_force) return;
  safety->force = kForce;
  safety->speed = kSpeed;
  safety->joint_torque = kJointTorque;
}

// Returns the name of the controller that a study's column shows. The scenario's own controller may
// be of a type that the study also contains with other parameters.
std::string ColumnOf(const StudyChoice& controller, const std::filesystem::path& file) {
  if (!controller.set.empty()) return controller.name;
  const std::string type = LoadScenario(file).cobot.controller.type;
  const auto others = StudiedControllers();
  const bool twice = std::ranges::any_of(
      others, [&](const StudyChoice& other) { return !other.set.empty() && other.name == type; });
  return twice ? type + " of the scenario" : type;
}

// Gives the controller the mass and the centre of mass of the load.
void SetLoad(Scenario* scenario) {
  const ObjectModel object = LoadObject(scenario->object, scenario->folder());
  const AttachmentSpec& at = scenario->object.attachment;
  // A ball joint transmits the object's weight to the cobot at the joint itself.
  const Pose X_EO = at.on_end_effector.ToPose() * at.on_object.ToPose().Inverse();
  const Vector3 com =
      at.joint == JointType::kSpherical ? at.on_end_effector.xyz : X_EO * object.com;
  scenario->cobot.controller.Set(Formatted("object_mass=%.9g", object.mass));
  scenario->cobot.controller.Set(
      Formatted("object_center_of_mass=[%.9g, %.9g, %.9g]", com.x(), com.y(), com.z()));
}

// Sets a gripping force that is too small to hold the object, even while the person carries part of
// the weight.
void SetGrip(Scenario* scenario) {
  const ObjectModel object = LoadObject(scenario->object, scenario->folder());
  scenario->events.front().Set(
      Formatted("slip_force=%.9g", kGripShare * object.mass * scenario->environment.gravity));
}

// Throws the InputError of a file that cannot be simulated even without the study's changes. In the
// study, such an error would look like a combination that is impossible.
void CheckFiles(const std::vector<std::filesystem::path>& files) {
  for (const std::filesystem::path& file : files) Emulator(LoadScenario(file));
}

// The part of a study that its threads share.
struct SharedStudy {
  explicit SharedStudy(const HazardStudyOptions& o) : options(o), store(o.folder / "runs.csv") {}

  const HazardStudyOptions& options;
  HazardRunStore store;
  std::atomic<std::size_t> done = 0;  // runs, including those that are impossible
  std::atomic<int> kept = 0;          // runs of an earlier, interrupted study
};

// Executes the runs of a cell that are not stored yet.
void AddRuns(HazardRuns* runs, const std::string& scenario, SharedStudy* study, HazardCell* cell) {
  // The first run serves as a sample of the program's behaviour, so that the study does not reuse
  // runs of a program with different behaviour.
  const HazardRun first = runs->Run(1);
  const std::string key = HexHash(scenario + TextOf(first));
  const auto seeds = static_cast<std::uint64_t>(study->options.seeds);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    HazardRun run;
    if (study->store.Find(key, seed, &run)) {
      ++study->kept;
    } else {
      run = seed == 1 ? first : runs->Run(seed);
      study->store.Add(key, *cell, run);
    }
    cell->runs.push_back(run);
    ++study->done;
  }
}

HazardCell MakeCell(const std::filesystem::path& file, const StudyChoice& controller,
                    const StudyChoice& hazard, SharedStudy* study) {
  HazardCell cell;
  cell.scenario = file.stem().string();
  cell.controller = ColumnOf(controller, file);
  cell.hazard = hazard.name;
  Scenario scenario;
  std::unique_ptr<HazardRuns> runs;
  try {
    scenario = StudiedScenario(file, controller, hazard, study->options.duration);
    runs = std::make_unique<HazardRuns>(scenario);
  } catch (const InputError& error) {
    cell.impossible = error.what();
    study->done += static_cast<std::size_t>(study->options.seeds);
    return cell;
  }
  cell.speed_cap = scenario.safety.handle_speed;
  cell.travel_budget = StopOfArms(scenario, MinStopAcceleration(scenario)).way;
  AddRuns(runs.get(), SaveScenario(scenario), study, &cell);
  return cell;
}

}  // namespace

std::vector<StudyChoice> StudiedControllers() {
  return {
      {kOwnController, {}},
      {"joint_impedance", Controller("type: joint_impedance, joint_stiffness: [600]")},
      {"admittance", Controller("type: admittance, damping_translation: 150, damping_rotation: 6")},
      {"variable_impedance",
       Controller("type: variable_impedance, damping_translation: 150, damping_rotation: 6")},
      {kLoadSharing, Controller("type: load_sharing, share: 1, damping_translation: 100")},
  };
}

std::vector<StudyChoice> StudiedHazards() {
  StudyChoice takeover = Hazard("takeover");
  takeover.set.emplace_back(
      "cobot.standby_controller={type: joint_impedance, joint_stiffness: [300]}");
  return {Hazard("brakes_close"),   Hazard("power_loss"),         Hazard("set_point_jump"),
          Hazard("stiffness_step"), Hazard("damping_step"),       Hazard("wrong_payload"),
          Hazard("wrong_friction"), Hazard("sensor_bias"),        Hazard("sensor_drift"),
          Hazard("control_delay"),  Hazard("control_freeze"),     takeover,
          Hazard(kSlips),           Hazard("object_breaks_loose")};
}

Scenario StudiedScenario(const std::filesystem::path& file, const StudyChoice& controller,
                         const StudyChoice& hazard, double duration) {
  std::vector<std::string> set = {Formatted("duration=%.9g", kAfter + duration)};
  for (const auto* more : {&controller.set, &hazard.set})
    set.insert(set.end(), more->begin(), more->end());
  Scenario scenario = LoadScenario(file, set);
  SetSafety(&scenario.cobot.safety);
  if (controller.name == kLoadSharing) SetLoad(&scenario);
  if (hazard.name == kSlips) SetGrip(&scenario);
  return scenario;
}

HazardStudy MakeHazardStudy(const HazardStudyOptions& options) {
  CheckFiles(options.scenarios);
  std::filesystem::create_directories(options.folder);
  SharedStudy shared(options);
  const std::vector<StudyChoice> controllers = StudiedControllers(), hazards = StudiedHazards();
  HazardStudy study;
  study.cells.resize(options.scenarios.size() * controllers.size() * hazards.size());
  const double count = static_cast<double>(study.cells.size()) * static_cast<double>(options.seeds);
  DoInParallel(
      study.cells.size(), options.workers,
      [&](std::size_t i) {
        const std::size_t c = i / hazards.size();
        study.cells[i] =
            MakeCell(options.scenarios[c / controllers.size()], controllers[c % controllers.size()],
                     hazards[i % hazards.size()], &shared);
      },
      [&] { options.progress(static_cast<double>(shared.done) / count); });
  study.kept = shared.kept;
  WriteWholeFile(options.folder / "hazards.csv", HazardStudyCsv(study));
  WriteWholeFile(options.folder / "hazards.md", HazardStudyTables(study));
  return study;
}

}  // namespace predictor
