#include "analysis/check/check.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "analysis/check/controller_advice.h"
#include "analysis/check/event_advice.h"
#include "analysis/check/hulls.h"
#include "core/error.h"
#include "core/format.h"
#include "core/units.h"
#include "emulator/stop_reach.h"
#include "models/arm_model.h"
#include "models/object_model.h"
#include "scenario/action_time.h"
#include "scenario/located.h"
#include "simulation/event_sequence.h"
#include "simulation/world.h"

namespace predictor {
namespace {

constexpr double kSlow =
    4;  // [Hz]; slower oscillations are caused by the virtual cobot, faster ones by the arms
constexpr double kNearTorqueLimit = 0.8;  // share that causes a warning

// Returns the pose that the object would have if the object had no weight and the attachment were
// at its zero position.
Pose UnsaggedObject(const Scenario& s, const RobotModel& cobot) {
  JointVector q = JointVector::Zero(cobot.dof());
  for (std::size_t j = 0; j < s.cobot.posture.size(); ++j)
    q[static_cast<int>(j)] = s.cobot.posture[j];
  RobotData data(cobot);
  data.UpdateKinematics(cobot, q, JointVector::Zero(cobot.dof()));
  const AttachmentSpec& attachment = s.object.attachment;
  return data.FramePose(cobot, cobot.Frame(s.cobot.end_effector)) *
         attachment.on_end_effector.ToPose() * attachment.on_object.ToPose().Inverse();
}

ModelsReport DescribeWorld(const Scenario& s, const RobotModel& cobot, const World& world) {
  ModelsReport report;
  report.cobot_mass = cobot.mass();
  report.cobot_joints = cobot.dof();
  report.object_mass = world.object_mass();
  report.X_WO = world.state().object.X_W;
  report.sag = report.X_WO.p - UnsaggedObject(s, cobot).p;
  for (int j = 0; j < cobot.dof(); ++j) {
    const double torque = std::fabs(world.state().torque[j]);
    const double share = torque / world.effort_limit()[j];
    if (!(share > report.torque_share)) continue;
    report.torque_share = share;
    report.torque = torque;
    report.torque_limit = world.effort_limit()[j];
    report.torque_joint = cobot.joint_name(j);
    report.torque_is_force = cobot.is_prismatic(j);
  }
  return report;
}

void DescribeArms(const Scenario& s, const DeviceReach& device, ModelsReport* report) {
  for (const int i : s.hands()) {
    const RobotModel& model = *device.arm(i)->model();
    ModelsReport::Arm arm;
    arm.mass = model.mass();
    arm.joints = model.dof();
    arm.payload_mass = s.arm(i).payload.mass;
    arm.reach = ((report->X_WO * HandlePose(s, i)).p - s.X_WB(i).p).norm();
    for (int j = 0; j < model.dof(); ++j) arm.joint_names.push_back(model.joint_name(j));
    report->arms[static_cast<std::size_t>(i)] = arm;
  }
}

// Derives problems and remedies from the results.
class Judge {
 public:
  Judge(const Scenario& s, const Machine* machine, CheckReport* report)
      : s_(s), machine_(machine), report_(report) {}

  void All() {
    Commissioned();
    Torques();
    Controller();
    for (std::string& line : StartWarnings(report_->start)) Warn(std::move(line));
    for (std::string& line : HullWarnings(s_, report_->start.pairs)) Warn(std::move(line));
    LooseObject();
    Script();
    for (std::string& line : EventWarnings(s_, report_->models.X_WO)) Warn(std::move(line));
    if (!report_->reach) return;
    for (std::size_t h = 0; h < kHands; ++h)
      if (report_->reach->arms[h]) Arm(h, *report_->reach->arms[h]);
    for (const PairReach& pair : report_->reach->pairs) Pair(pair);
    Speeds();
    Stability();
    for (const ContactReport& contact : report_->contacts) Contact(contact);
  }

 private:
  void Bad(std::string sentence) { report_->problems.push_back(std::move(sentence)); }
  void Warn(std::string sentence) { report_->warnings.push_back(std::move(sentence)); }

  void Commissioned() {
    if (!machine_) return;
    for (const std::string& line : UnmeasuredLoops(*machine_, s_)) Warn(line);
    for (const std::string& line : UntestedPushes(*machine_, s_)) Warn(line);
  }

  void Torques() {
    const ModelsReport& m = report_->models;
    const char* unit = m.torque_is_force ? "N" : "N·m";
    // If a joint exceeded its torque limit, the virtual world would have no equilibrium.
    if (m.torque_share < kNearTorqueLimit) return;
    Warn(Formatted(
        "Holding the object at rest requires %.1f %s at the cobot's joint %s, but the limit of "
        "this joint is %.1f %s. Little torque is left for motion. Use a lighter object, start in a "
        "posture closer to the base, or raise cobot.effort_limit.",
        m.torque, unit, m.torque_joint.c_str(), m.torque_limit, unit));
  }

  void Controller() {
    if (!report_->controller.is_stable()) Bad(ControllerProblem(s_, *report_));
  }

  // Warns of an event after which a part of this report no longer applies.
  void AfterEvent(std::size_t i, const char* kind, const char* consequence) {
    Warn(Formatted("After events.%zu (%s), %s Simulate the scenario to see what follows the event.",
                   i, kind, consequence));
  }

  void LooseObject() {
    const EventSequence events(s_);
    for (std::size_t i = 0; i < events.size(); ++i) {
      const HazardKind& kind = events.kind(i);
      if (kind.needs == HazardNeeds::kMovable)
        AfterEvent(i, kind.name,
                   "the object may hold a movable object. The reach, the stability margin and the "
                   "torques in this report are those without it.");
      if (kind.needs == HazardNeeds::kSlipping || kind.needs == HazardNeeds::kNoEnd ||
          kind.needs == HazardNeeds::kRelease)
        AfterEvent(i, kind.name,
                   "the object may be loose. The reach, stability and torques in this report apply "
                   "only while the object is attached to the cobot.");
    }
  }

  void Script() {
    if (s_.operator_.type != "virtual") return;
    const auto& script = s_.operator_.script;
    if (std::none_of(script.begin(), script.end(),
                     [](const ActionSpec& a) { return a.action == "grip"; }))
      Warn(
          "No one grips the handles: operator.script has no grip, so it has no effect. Begin it "
          "with {action: grip, start: 0.5}.");
    double end = 0;
    for (const ActionSpec& a : script) end = std::max(end, a.start + ActionTime(a));
    if (end > s_.duration)
      Warn(
          Formatted("The run ends at %.1f s, but the operator's script ends at %.1f s, so its last "
                    "part is not executed. Increase duration, or shorten the script.",
                    s_.duration, end));
  }

  void Arm(std::size_t h, const ArmReach& r) {
    const char* name = kHandNames[h];
    std::string placement = PlacementRemedy(s_, static_cast<int>(h));
    placement[0] = static_cast<char>(std::toupper(placement[0]));
    const char* remedy = placement.c_str();
    const auto joint = [&](int j) { return report_->JointName(h, j); };
    if (r.lost) {
      Bad(
          Formatted("The %s arm cannot follow the operator's path: its handle is out of reach from "
                    "%.2f s. %s, or shorten the motions of the script.",
                    name, *r.lost, remedy));
      return;
    }
    if (r.singular_value.value < kMinSingularValue)
      Bad(Formatted(
          "The %s arm comes too close to a singularity: its smallest singular value is "
          "%.3f m at %.2f s, but at least %.2f m is required. %s.",
          name, r.singular_value.value, r.singular_value.time, kMinSingularValue, remedy));
    if (r.joint_margin.value < s_.rendering.joint_security)
      Bad(
          Formatted("The %s arm's joint %s comes within %.3f rad of its limit at %.2f s, but "
                    "rendering.joint_security requires %.3f rad. %s or choose another posture.",
                    name, joint(r.joint_margin.joint).c_str(), r.joint_margin.value,
                    r.joint_margin.time, s_.rendering.joint_security, remedy));
    if (std::isinf(r.joint_speed.value))
      Bad(
          Formatted("The %s arm's joint %s would have to move beyond rendering.joint_security at "
                    "%.2f s, but rendering stops it there. %s or choose another posture.",
                    name, joint(r.joint_speed.joint).c_str(), r.joint_speed.time, remedy));
    else if (r.joint_speed.value > 1)
      Bad(
          Formatted("The %s arm's joint %s would need %.1f times its allowed speed at %.2f s. %s "
                    "or slow the script down.",
                    name, joint(r.joint_speed.joint).c_str(), r.joint_speed.value,
                    r.joint_speed.time, remedy));
  }

  void Pair(const PairReach& pair) {
    if (pair.distance.value >= s_.rendering.security_distance) return;
    Bad(
        Formatted("The links %s approach each other to %.3f m at %.2f s, but "
                  "rendering.security_distance is %.3f m. Move the bases of the arms apart.",
                  pair.name.c_str(), pair.distance.value, pair.distance.time,
                  s_.rendering.security_distance));
  }

  void Speeds() {
    for (std::size_t h = 0; h < kHands; ++h) {
      const HandleReach& r = report_->reach->handles[h];
      if (r.speed.value > s_.safety.handle_speed)
        Warn(Formatted(
            "The script moves the %s handle at %.2f m/s (at %.2f s), but safety.handle_speed "
            "limits it to %.2f m/s. A person would feel a resistance.",
            kHandNames[h], r.speed.value, r.speed.time, s_.safety.handle_speed));
      if (r.rotation_speed.value > s_.safety.handle_rotation_speed)
        Warn(
            Formatted("The script rotates the %s handle at %.0f °/s (at %.2f s), but "
                      "safety.handle_rotation_speed limits it to %.0f °/s.",
                      kHandNames[h], kDegrees * r.rotation_speed.value, r.rotation_speed.time,
                      kDegrees * s_.safety.handle_rotation_speed));
    }
  }

  void Stability() {
    const StabilityReport& r = *report_->stability;
    if (Suffices(r.margin)) return;
    const bool other_lead = !r.chosen && (Suffices(r.without_lead) || Suffices(r.full_lead));
    const char* lead = r.withheld   ? "First measure the arms' velocity loops (see the warnings), "
                                      "because lag compensation requires this measurement. "
                       : other_lead ? "Change rendering.lead, or set it to auto. "
                                    : "";
    const std::string change =
        r.margin.frequency < kSlow
            ? "This is an oscillation of the cobot with its load. " + MoreDamping(s_.cobot) +
                  " or reduce the hand's visual correction (operator.hand.visual_stiffness)."
            : "Use a heavier object, a softer or lighter hand, faster arms (" +
                  std::string(machine_ ? "arms.*.arm.loop" : "device.arms.*.loop") +
                  ") or a faster loop (rate).";
    Bad(Formatted(
        "The stability margin of the haptic loop is too small: %.2f at a lead of %.1f ms, but at "
        "least %.0f is required (it would oscillate at %.1f Hz). %s%s",
        r.margin.gain, 1e3 * r.lead, kMinMargin, r.margin.frequency, lead, change.c_str()));
  }

  // The loop may be unstable even without contact. The function Stability reports such a loop.
  void Contact(const ContactReport& r) {
    if (report_->stability->margin.gain < 1) return;
    const std::string what =
        KeyOf(r.surfaces[0]) + ": the haptic loop oscillates while the object ";
    const bool is_fixture = r.surfaces[0].kind == Surface::Kind::kFixture;
    const std::string limit =
        r.yields && r.limit.reached
            ? Formatted(
                  " With the damping of this fixture, the total stiffness of all points of contact "
                  "can be at most %.3g N/m; with a larger stiffness, the loop would oscillate at "
                  "%.1f Hz.",
                  r.limit.stiffness, r.limit.frequency)
            : "";
    if (!r.stable && is_fixture)
      Warn(what + "touches this fixture." + limit +
           " Reduce the stiffness of the fixture, increase its damping, use lighter hands, or use "
           "faster arms.");
    else if (!r.stable && r.is_movable())
      Warn(what +
           "touches this movable object and cannot push it away. Use lighter hands or faster "
           "arms.");
    else if (!r.stable)
      Warn(what +
           "touches it. Use lighter hands or faster arms, or replace it by a fixture with a "
           "stiffness.");
    if (r.pushed && !r.pushed->stable)
      Warn(what + "pushes this movable object. Use lighter hands or faster arms.");
    if (r.held && !r.held->stable)
      Warn(what + "holds this movable object. Use lighter hands or faster arms.");
  }

  const Scenario& s_;
  const Machine* machine_;
  CheckReport* report_;
};

void CheckDevice(const Scenario& s, const World& world, const CheckOptions& options,
                 CheckReport* report) {
  const DeviceReach device(s);
  DescribeArms(s, device, &report->models);
  const auto paths = TaskPaths(s, report->models.X_WO, kPathStep);
  options.progress(0.02, "reach");
  report->reach = device.Over(paths);
  report->comfort = Comfort(*report->reach, s.rendering);
  for (int i = 0; i < kHands; ++i) {
    report->arm_key[static_cast<std::size_t>(i)] = ArmKey(s, i);
    if (s.Has(i)) report->base[static_cast<std::size_t>(i)] = s.arm(i).base.xyz;
  }
  report->stop = StopOfArms(s);
  report->longest_stop = StopOfArms(s, MinStopAcceleration(s));
  report->handle_speed = s.safety.handle_speed;
  const double begin = 0.05;
  const double middle = options.search ? 0.6 : begin;
  report->shift = s.environment.shift.value_or(PoseSpec());
  const char* what = s.HasFixedArms() ? "shift" : "bases";
  const OnProgress searching = [&](double share) {
    options.progress(begin + share * (middle - begin), what);
  };
  if (options.search && s.HasFixedArms())
    report->shift_proposal = SearchShift(s, paths, searching);
  else if (options.search)
    report->proposal = SearchBases(s, device, paths, searching);
  const LinearModel linear = world.Linearise();
  report->stability = CheckStability(
      s, linear, {0.8, 1.5, 3}, {100, 250, 500, 1000},
      [&](double share) { options.progress(middle + share * (1 - middle), "stability"); });
  report->contacts =
      CheckContacts(s, world, report->stability->lead, CanReachFloor(s, report->models.X_WO));
  report->link_contacts = LinkContacts(s);
  report->stability->withheld = options.machine && !UnmeasuredLoops(*options.machine, s).empty();
}

}  // namespace

CheckReport Check(const Scenario& s, const CheckOptions& options) try {
  options.progress(0, "models");
  const World world(s);
  CheckReport report;
  report.scenario = s.name;
  report.direct = s.mode == Mode::kDirect;
  report.security_distance = s.rendering.security_distance;
  const auto cobot = LoadCobotModel(s);
  report.models = DescribeWorld(s, *cobot, world);
  report.controller = world.JudgeController();
  report.controller_joint = world.joint_names()[static_cast<std::size_t>(report.controller.joint)];
  report.start = DescribeStart(s, *cobot, world);
  if (!report.direct) CheckDevice(s, world, options, &report);
  Judge(s, options.machine, &report).All();
  return report;
} catch (const InputError& error) {
  throw Located(error, s);
}

}  // namespace predictor
