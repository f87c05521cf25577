#include "analysis/hazard_study/hazard_study.h"

#include <algorithm>
#include <atomic>

#include "analysis/hazard_study/run_measures.h"
#include "analysis/hazard_study/run_store.h"
#include "analysis/json_line_store.h"
#include "analysis/parallel.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "core/norm.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "emulator/stop_reach.h"
#include "evaluation/summary.h"
#include "models/object_model.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

// The hazard begins at a random time in this window, so that an operator cannot anticipate it.
constexpr double kAfter = 2, kWindow = 2;  // [s]
// The cobot's own limits in the study are a design choice. They are wide enough for every
// undisturbed run.
const std::vector<std::string> kCobotSafety = {"cobot.safety.force=100", "cobot.safety.speed=0.75",
                                               "cobot.safety.joint_torque=60"};

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

// A cell with the scenario of its runs.
struct Piece {
  HazardCell cell;
  Scenario scenario;
  HazardRun first;  // the run with seed 1
  std::string key;
};

// Returns by how much the true force of the hand that caused the stop exceeds `threshold` [N].
double ExcessOf(const TickRecord& record, double threshold) {
  const HandRecord& hand = record.hands[static_cast<std::size_t>(record.cause_hand)];
  return std::max(0.0, Norm(hand.true_wrench.data()) - threshold);
}

ClearCrossing CrossingOf(const Scenario& scenario) {
  std::array<double, kHands> resolved = {};
  for (const int i : scenario.hands())
    resolved[static_cast<std::size_t>(i)] = ResolvedForce(scenario.arm(i).sensor);
  return {scenario.safety.force, resolved};
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

Piece PieceOf(const std::filesystem::path& file, const StudyChoice& controller,
              const StudyChoice& hazard, double duration) {
  Piece piece;
  piece.cell.scenario = file.stem().string();
  piece.cell.controller = controller.name;
  piece.cell.hazard = hazard.name;
  try {
    piece.scenario = StudiedScenario(file, controller, hazard, duration);
    // The first run serves as a sample of the program's behaviour, so that the study does not reuse
    // runs of a program with different behaviour.
    piece.first = RunWithHazard(piece.scenario, 1);
    piece.key = HexHash(SaveScenario(piece.scenario) + TextOf(piece.first));
  } catch (const InputError& error) {
    piece.cell.impossible = error.what();
    return piece;
  }
  piece.cell.speed_cap = piece.scenario.safety.handle_speed;
  piece.cell.travel_budget = StopOfArms(piece.scenario, MinStopAcceleration(piece.scenario)).way;
  return piece;
}

}  // namespace

std::vector<StudyChoice> StudiedControllers() {
  return {
      {"cartesian_impedance", {}},
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
  std::vector<std::string> set = {Formatted("duration=%g", duration)};
  for (const auto* more : {&controller.set, &hazard.set, &kCobotSafety})
    set.insert(set.end(), more->begin(), more->end());
  Scenario scenario = LoadScenario(file, set);
  if (controller.name == kLoadSharing) SetLoad(&scenario);
  if (hazard.name == kSlips) SetGrip(&scenario);
  return scenario;
}

HazardRun RunWithHazard(Scenario scenario, std::uint64_t seed) {
  scenario.seed = seed;
  HazardRun run;
  run.seed = seed;
  SummaryBuilder builder(scenario);
  ClearCrossing crossing = CrossingOf(scenario);
  CommandedSpeeds commanded(scenario);
  Emulator emulator(scenario);
  Simulate(&emulator, scenario.duration, [&](const TickRecord& record) {
    builder.Add(record);
    crossing.Add(record);
    commanded.Add(record);
    if (run.excess < 0 && record.cause == StopCause::kForce && record.cause_hand >= 0) {
      run.excess = ExcessOf(record, scenario.safety.force);
      run.clear_detection = crossing.duration(record.cause_hand);
    }
    if (record.ran == 0 || record.latest_event != 0) return;
    for (const HandRecord& hand : record.hands)
      if (hand.present != 0) run.before = std::max(run.before, Norm(hand.wrench.data()));
  });
  const Summary summary = builder.summary();
  const EventSummary& event = summary.events.front();
  const auto largest = [](const std::array<double, kHands>& values) {
    return *std::max_element(values.begin(), values.end());
  };
  run.begin = event.begin.value_or(-1);
  run.commanded = commanded.share();
  run.after = largest(event.force);
  run.torque = largest(event.torque);
  run.speed = largest(event.speed);
  run.until_stop = event.until_stop.value_or(-1);
  if (summary.cobot_stop) run.cobot_stop = summary.cobot_stop->reason;
  if (summary.stops.empty()) return run;
  const StopSummary& stop = summary.stops.front();
  run.cause = stop.cause;
  run.detection = stop.cause == StopCause::kForce ? stop.detection.value_or(-1) : -1;
  run.travel = stop.distance;
  return run;
}

HazardStudy MakeHazardStudy(const HazardStudyOptions& options) {
  CheckFiles(options.scenarios);
  std::filesystem::create_directories(options.folder);
  HazardRunStore store(options.folder / "runs.csv");
  const auto seeds = static_cast<std::size_t>(options.seeds);
  std::atomic<std::size_t> done = 0;
  const std::vector<StudyChoice> controllers = StudiedControllers(), hazards = StudiedHazards();
  std::vector<Piece> pieces(options.scenarios.size() * controllers.size() * hazards.size());
  const std::size_t count = pieces.size() * (seeds + 1);
  const auto report = [&] {
    options.progress(static_cast<double>(done) / static_cast<double>(count));
  };
  DoInParallel(
      pieces.size(), options.workers,
      [&](std::size_t i) {
        const std::size_t c = i / hazards.size();
        pieces[i] =
            PieceOf(options.scenarios[c / controllers.size()], controllers[c % controllers.size()],
                    hazards[i % hazards.size()], options.duration);
        ++done;
      },
      report);
  for (Piece& piece : pieces)
    if (piece.cell.impossible.empty()) piece.cell.runs.resize(seeds);

  std::atomic<int> kept = 0;
  DoInParallel(
      pieces.size() * seeds, options.workers,
      [&](std::size_t i) {
        Piece& piece = pieces[i / seeds];
        ++done;
        if (!piece.cell.impossible.empty()) return;
        HazardRun& run = piece.cell.runs[i % seeds];
        const std::uint64_t seed = i % seeds + 1;
        if (store.Find(piece.key, seed, &run)) {
          ++kept;
          return;
        }
        run = seed == 1 ? piece.first : RunWithHazard(piece.scenario, seed);
        store.Add(piece.key, piece.cell, run);
      },
      report);

  HazardStudy study;
  study.kept = kept;
  for (Piece& piece : pieces) study.cells.push_back(std::move(piece.cell));
  WriteWholeFile(options.folder / "hazards.csv", HazardStudyCsv(study));
  WriteWholeFile(options.folder / "hazards.md", HazardStudyTables(study));
  return study;
}

}  // namespace predictor
