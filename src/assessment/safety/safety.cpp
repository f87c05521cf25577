#include "assessment/safety/safety.h"

#include <algorithm>
#include <utility>

#include "assessment/output.h"
#include "core/error.h"
#include "core/text.h"
#include "scenario/own_parameters.h"

namespace predictor::assessment {
namespace {

// Returns the hazard that had begun last when the value was largest, or "". The number of an event
// is that of its hazard in the catalogue, not that of its entry in the scenario.
std::string EventOf(const SafetyCollector::LargestValue& largest) {
  const ParameterKinds hazards = Hazards();
  const std::size_t number = largest.event;
  if (number == 0) return "";
  return number <= hazards.size() ? hazards[number - 1]->name
                                  : "number " + std::to_string(number) + " of the catalogue";
}

std::vector<RigLimit> RigLimits(const Scenario& scenario, const SafetyCollector::Largest& largest) {
  constexpr Unit kRotationSpeed = {"rad/s", "rad/s", 1, 2};
  const SafetySpec& safety = scenario.safety;
  std::vector<RigLimit> limits = {{"force of a hand", units::kNewton, safety.force,
                                   largest.force.value, EventOf(largest.force)},
                                  {"torque of a hand", units::kNewtonMetre, safety.torque,
                                   largest.torque.value, EventOf(largest.torque)}};
  if (scenario.mode != Mode::kEmulate) return limits;
  limits.push_back({"speed of a virtual handle", units::kMetrePerSecond, safety.handle_speed,
                    largest.speed.value, EventOf(largest.speed)});
  limits.push_back({"rotation of a virtual handle", kRotationSpeed, safety.handle_rotation_speed,
                    largest.rotation_speed.value, EventOf(largest.rotation_speed)});
  return limits;
}

void AddGaps(const Scenario& scenario, const SafetyOptions& options, const SafetyCollector& run,
             SafetyAssessment* safety) {
  const auto add = [&](const char* what, const char* why) {
    safety->not_evaluable.push_back({what, why});
  };
  if (!options.masses) {
    add("fall of the object", "the masses of the virtual scene are not known");
    add("unintended contact", "the masses of the virtual scene are not known");
  } else if (!options.limits) {
    add("unintended contact",
        "no limits for the force on the body are given (--contact-limits FILE; "
        "assets/contact_limits_template.csv is a template)");
  } else {
    add("pressure of an unintended contact", "the area of contact is not known");
    if (!safety->contact->clamping_force)
      add("clamping between object and fixture",
          "the scenario neither bounds the cobot's force (cobot.safety.force_cap) nor stops the "
          "cobot at a force (cobot.safety.force)");
  }
  add("distance between the person's body and the links of the cobot",
      "the evaluation does not load the shapes of the links");
  if (!run.scene().knows_the_outline())
    add("speed of the points of the object beside its origin and its handles",
        "the recording contains no simple shapes of the object (meshes are not used here), so its "
        "fastest point may be faster than stated");
  if (!run.margins().known())
    add("distance of the cobot from its joint limits and from singular postures",
        "the recording has lost the model of the cobot");
  for (const RigLimit& limit : safety->rig)
    if (limit.censored())
      safety->not_evaluable.push_back(
          {limit.what + " above " + NumberText(limit.unit, limit.limit) + " " + limit.unit.shown,
           limit.event.empty()
               ? "the run reached this limit of the rig, and no event of the scenario had begun"
               : "the run reached this limit of the rig after the event " + Printable(limit.event) +
                     " had begun"});
  if (scenario.operator_.type == "person")
    add("moments at which the person let go", "real arms cannot sense whether a hand is there");
  if (scenario.mode == Mode::kEmulate)
    add("jolts that are too fast for the arms to follow",
        "the real handles low-pass the motion of the virtual ones");
}

}  // namespace

SafetyCollector::SafetyCollector(const Scenario& scenario, std::vector<OutlinePoint> outline,
                                 std::shared_ptr<const RobotModel> cobot)
    : exposure_(scenario),
      stops_(scenario),
      scene_(std::move(outline)),
      margins_(scenario, std::move(cobot)) {}

void SafetyCollector::Add(const TickRecord& record) {
  exposure_.Add(record);
  stops_.Add(record);
  scene_.Add(record);
  margins_.Add(record);
  if (!record.ran) return;
  for (const HandRecord& hand : record.hands) {
    if (!hand.present) continue;
    const auto raise = [&](LargestValue* most, const std::array<double, 6>& v, std::size_t k) {
      const double value = Vector3(v[k], v[k + 1], v[k + 2]).norm();
      if (value > most->value) *most = {value, record.latest_event};
    };
    raise(&largest_.force, hand.wrench, 0);
    raise(&largest_.torque, hand.wrench, 3);
    raise(&largest_.speed, hand.virtual_.twist, 0);
    raise(&largest_.rotation_speed, hand.virtual_.twist, 3);
  }
}

SafetyAssessment JudgeSafety(const Scenario& scenario, const PersonSetup& setup,
                             const SafetyCollector& run, const SafetyOptions& options) {
  if (run.scene().empty())
    throw InputError("No simulated time passed in this run, so there is nothing to judge.");
  SafetyAssessment safety;
  safety.simulated = scenario.operator_.type == "virtual";
  safety.exposure = run.exposure().results();
  for (const StopWindow& window : run.stops().windows())
    safety.stops.push_back(JudgeStop(setup, window, options.intervals));
  safety.separation = SeparationOf(run.scene(), setup);
  if (options.masses) safety.drop = DropOf(run.scene(), *options.masses, setup, scenario);
  if (options.masses && options.limits)
    safety.contact = ContactOf(run.scene(), *options.masses, *options.limits, scenario);
  safety.rig = RigLimits(scenario, run.largest());
  safety.margins = run.margins().results();
  AddGaps(scenario, options, run, &safety);
  return safety;
}

}  // namespace predictor::assessment
