#include "devices/faults.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>

#include "core/words.h"
#include "devices/fault_processes.h"
#include "devices/fault_scenes.h"
#include "devices/fault_starts.h"
#include "devices/franka/packets.h"
#include "devices/solver_faults.h"
#include "devices/wire/bytes.h"
#include "support/brisk.h"

namespace predictor {
namespace {

void Copy(const std::string& text, std::array<char, 600>* to) {
  const std::size_t n = std::min(text.size(), to->size() - 1);
  std::copy_n(text.begin(), n, to->begin());
  (*to)[n] = 0;
}

bool Carries(Carrier carrier, const std::string& arm, const std::string& sensor) {
  switch (carrier) {
    case Carrier::kLoop:
    case Carrier::kArm:
      return true;
    case Carrier::kUr:
      return arm == "ur";
    case Carrier::kFranka:
      return arm == "franka";
    case Carrier::kNetFt:
      return sensor == "net_ft";
    case Carrier::kUrWrench:
      return arm == "ur" && sensor.empty();
    case Carrier::kFrankaWrench:
      return arm == "franka" && sensor.empty();
  }
  return false;
}

// Adds a force to the readings of a sensor.
void Push(Bench& bench, int hand, double force) {
  Wrench F = Wrench::Zero();
  F[2] = force;
  bench.rig().Disturb(hand, JointVector(), F);
}

// Returns the number that replaces another one in an arm's packets.
using Change = std::function<double(double)>;

// If two faults change the same bytes, both take effect.
void Corrupt(WireFaults* wire, std::function<void(Bytes*)> change) {
  wire->corrupt = [before = std::move(wire->corrupt), change = std::move(change)](Bytes* bytes) {
    if (before) before(bytes);
    change(bytes);
  };
}

// Each packet of a UR arrives separately. `place` is the offset of the number from the beginning of
// the packet or, if negative, from its end.
void ChangeUr(WireFaults* wire, int place, const Change& change) {
  Corrupt(wire, [place, change](Bytes* bytes) {
    if (bytes->size() < 100 || (*bytes)[2] != std::byte{'U'}) return;
    const auto at = place < 0 ? bytes->size() - static_cast<std::size_t>(-place)
                              : static_cast<std::size_t>(place);
    const auto there = std::span(*bytes).subspan(at, 8);
    const auto number = BigEndianReader(there).Get<double>();
    BigEndianWriter(there).Put(change(number));
  });
}
void ChangeFranka(WireFaults* wire, std::size_t place, const Change& change) {
  Corrupt(wire, [place, change](Bytes* bytes) {
    if (bytes->size() != sizeof(fci::Research3State)) return;
    const auto there = std::span(*bytes).subspan(place, sizeof(float));
    const auto number = LittleEndianReader(there).Get<float>();
    LittleEndianWriter(there).Put(static_cast<float>(change(static_cast<double>(number))));
  });
}
constexpr int kTimeOfUr = 3 + 1;                 // header, recipe
constexpr int kSecondJointOfUr = 3 + 1 + 8 + 8;  // followed by timestamp, first joint
constexpr int kForceOfUr = -48;                  // the wrench is at the end
constexpr std::size_t kSecondJointOfFranka = offsetof(fci::Signals<float>, q) + sizeof(float);
constexpr std::size_t kForceOfFranka = offsetof(fci::Signals<float>, K_F_ext_hat_K);

void CutEachTenth(WireFaults* wire) {
  Corrupt(wire, [n = 0](Bytes* bytes) mutable {
    if (++n % 10 == 0 && !bytes->empty()) bytes->pop_back();
  });
}

// The time or the state numbers begin again at zero, as after a restart of the arm, but the
// connection stays the same.
void RestartUrClock(WireFaults* wire) {
  ChangeUr(wire, kTimeOfUr, [begun = -1.0](double time) mutable {
    if (begun < 0) begun = time;
    return time - begun;
  });
}
void RestartFrankaNumbering(WireFaults* wire) {
  Corrupt(wire, [begun = std::optional<std::uint64_t>()](Bytes* bytes) mutable {
    if (bytes->size() != sizeof(fci::Research3State)) return;
    const auto there = std::span(*bytes).first(sizeof(std::uint64_t));
    const auto number = LittleEndianReader(there).Get<std::uint64_t>();
    if (!begun) begun = number;
    LittleEndianWriter(there).Put(number - *begun + 1);
  });
}

double Jump(double q) { return q + 0.2; }
double NotANumber(double) { return std::numeric_limits<double>::quiet_NaN(); }
double Huge(double) { return 1e6; }

// Repeats the same reading in new packets.
void FreezeWrench(WireFaults* wire, std::size_t before_end, std::size_t bytes_of_it) {
  Corrupt(wire, [=, first = Bytes()](Bytes* bytes) mutable {
    if (bytes->size() < 100) return;
    const auto at = bytes->end() - static_cast<std::ptrdiff_t>(before_end);
    const auto end = at + static_cast<std::ptrdiff_t>(bytes_of_it);
    if (first.empty()) first.assign(at, end);
    std::copy(first.begin(), first.end(), at);
  });
}

// Makes a controller follow joint velocities faster than the scenario's arm does.
void MakeQuick(std::optional<ArmSpec>* arm) {
  if (*arm) (*arm)->loop = {60, 0.9, 0.001};
}

std::function<void(Bench&, int)> ToArm(const std::string& what) {
  return [what](Bench& b, int hand) {
    if (!b.arm(hand).Do(what)) throw std::runtime_error("unknown event of an arm: " + what);
  };
}
std::function<void(Bench&, int)> ToSensor(const std::string& what) {
  return [what](Bench& b, int hand) {
    if (!b.sensor(hand).Do(what)) throw std::runtime_error("unknown event of a sensor: " + what);
  };
}
std::function<void(Bench&, int)> ToWire(void (*change)(WireFaults*)) {
  return [change](Bench& b, int hand) { change(&b.wire(hand)); };
}
std::function<void(Bench&, int)> ToSensorsWire(void (*change)(WireFaults*)) {
  return [change](Bench& b, int hand) { change(&b.sensor_wire(hand)); };
}

void AskToStop(Bench& b, int) { b.emulator().Request(RunEvent::kStopRequested); }

template <std::size_t kMilliseconds>
void Hinder(Bench& b, int hand) {
  b.rig().Hinder(hand, kMilliseconds);
  b.Pass(0.2);
}

// The program requests power-off in the tick after 20 ms of silence.
Fault Silent(Fault fault) {
  fault.off = 21;
  return fault;
}

Fault Late(Fault fault) {
  fault.lag = 0.010;
  return fault;
}

// Each bound includes the age limit of 5 ms, two ticks, and a cycle of the controller. A Franka
// itself ends a motion after 20 ms without commands.
std::vector<Fault> FaultsOfWires() {
  using enum Carrier;
  using enum Expect;
  return {
      // If one datagram in ten were lost, five in a row would be lost in one of a hundred runs, and
      // this loss would stop the run.
      {1, "a twentieth of the sensor's datagrams lost", kNetFt, kWarned, 0,
       ToSensorsWire([](WireFaults* w) { w->loss = 0.05; })},
      {1, "a twentieth of the arm's states lost", kFranka, kWarned, 0,
       ToWire([](WireFaults* w) { w->loss = 0.05; })},
      {2, "samples late by 12 ms", kUr, kHold, 9, ToWire([](WireFaults* w) { w->delay += 0.012; })},
      {2, "states late by 12 ms: no command comes in time", kFranka, kHold, 9,
       ToWire([](WireFaults* w) { w->delay += 0.012; }), false},
      Silent({3, "arm silent", kUr, kPowerOff, 9, ToWire([](WireFaults* w) { w->silent = true; })}),
      Silent({3, "arm silent: no state to answer", kFranka, kPowerOff, 9,
              ToWire([](WireFaults* w) { w->silent = true; }), false}),
      Silent({3, "sensor silent", kNetFt, kPowerOff, 9,
              ToSensorsWire([](WireFaults* w) { w->silent = true; })}),
      {4, "samples late by 0 to 2 ms", kUr, kContinues, 0,
       ToWire([](WireFaults* w) { w->jitter = 0.002; })},
      {4, "readings late by 0 to 2 ms", kNetFt, kContinues, 0,
       ToSensorsWire([](WireFaults* w) { w->jitter = 0.002; })},
      {4, "states late by 1 ms: each command is too late", kFranka, kHold, 30,
       ToWire([](WireFaults* w) { w->delay += 0.001; }), false},
      {5, "sensor's datagrams out of order", kNetFt, kWarned, 0,
       ToSensorsWire([](WireFaults* w) { w->reorder = 0.5; })},
      {5, "arm's states out of order", kFranka, kWarned, 0,
       ToWire([](WireFaults* w) { w->reorder = 0.05; })},
      {6, "sensor's datagrams twice", kNetFt, kContinues, 0,
       ToSensorsWire([](WireFaults* w) { w->duplicate = 0.5; })},
      {6, "arm's states twice", kFranka, kContinues, 0,
       ToWire([](WireFaults* w) { w->duplicate = 0.5; })},
      Silent({6, "the arm's last package for ever", kUr, kPowerOff, 9, ToArm("repeat")}),
      Silent({6, "the arm's last state for ever", kFranka, kPowerOff, 9, ToArm("replay state"),
              false}),
      // After a device restarts its counter, its readings look old until the counter has passed its
      // previous value. The fault is therefore equivalent to silence.
      Silent({7, "a sensor restarts its numbering", kNetFt, kPowerOff, 9, ToSensor("restart")}),
      Silent({7, "an arm restarts its clock", kUr, kPowerOff, 9, ToWire(RestartUrClock)}),
      Silent({7, "an arm restarts its numbering", kFranka, kPowerOff, 9,
              ToWire(RestartFrankaNumbering), false}),
      Silent({8, "sensor's datagrams cut", kNetFt, kPowerOff, 9, ToSensor("short")}),
      // The bench's network counts these datagrams. sockets_test.cpp shows that a socket discards
      // and counts such datagrams. Here the operator must see a warning with the count, and the run
      // must continue.
      {8, "datagrams from another sender", kNetFt, kWarned, 0,
       ToSensorsWire([](WireFaults* w) { w->spoofed = true; })},
      {8, "a tenth of the sensor's datagrams cut", kNetFt, kWarned, 0,
       ToSensorsWire([](WireFaults* w) { CutEachTenth(w); })},
      {8, "a tenth of the arm's states cut", kFranka, kWarned, 0,
       ToWire([](WireFaults* w) { CutEachTenth(w); })},
      {9, "malformed frame", kUr, kPowerOff, 4, ToArm("malformed"), false},
      {10, "stream cut at every byte", kUr, kContinues, 0,
       ToWire([](WireFaults* w) { w->split = true; })},
      Silent({11, "half-open connection", kArm, kPowerOff, 9,
              ToWire([](WireFaults* w) { w->silent = w->deaf = true; }), false}),
      {11, "connection closed", kArm, kPowerOff, 3, ToWire([](WireFaults* w) { w->closed = true; }),
       false},
  };
}

std::vector<Fault> FaultsOfDevices() {
  using enum Carrier;
  using enum Expect;
  return {
      {12, "protective stop of one arm", kUr, kHold, 4, ToArm("protective stop"), false},
      {12, "reflex of one arm", kFranka, kHold, 2, ToArm("reflex cartesian_reflex"), false},
      {13, "emergency stop of one arm", kUr, kPowerOff, 4, ToArm("emergency stop"), false},
      {13, "emergency stop of one arm", kFranka, kPowerOff, 2, ToArm("emergency stop"), false},
      {13, "user stop of one arm", kFranka, kPowerOff, 2, ToArm("user stop"), false},
      Late({15, "an arm that lags by another 10 ms, stopped", kArm, kHold, 1, AskToStop, true,
            Hinder<10>}),
      // The position of the arm is unknown, so the program must not hold it.
      Silent({17, "joints that are no numbers any more", kUr, kPowerOff, 4, ToArm("not a number")}),
      {17, "arm's own wrench not a number", kUrWrench, kPowerOff, 3,
       ToWire([](WireFaults* w) { ChangeUr(w, kForceOfUr, NotANumber); })},
      {17, "arm's own wrench not a number", kFrankaWrench, kHold, 1,
       ToWire([](WireFaults* w) { ChangeFranka(w, kForceOfFranka, NotANumber); })},
      {18, "arm's own sensor beyond its range", kUrWrench, kPowerOff, 3,
       ToWire([](WireFaults* w) { ChangeUr(w, kForceOfUr, Huge); })},
      {18, "sensor saturated", kNetFt, kPowerOff, 3, ToSensor("saturate")},
      {19, "sensor's payload frozen", kNetFt, kHold, 53, ToSensor("freeze")},
      {19, "arm's own wrench frozen", kUrWrench, kHold, 102,
       ToWire([](WireFaults* w) { FreezeWrench(w, 48, 48); })},
      {19, "arm's own wrench frozen", kFrankaWrench, kHold, 53, ToWire([](WireFaults* w) {
         FreezeWrench(w, sizeof(fci::Research3State) - kForceOfFranka, 6 * sizeof(float));
       })},
      // The bound is two ticks plus the time until the sensor's next reading.
      {21, "60 N on a handle, own sensor", kUrWrench, kHold, 4,
       [](Bench& b, int hand) { Push(b, hand, 60); }},
      {21, "60 N on a handle, own estimate", kFrankaWrench, kHold, 3,
       [](Bench& b, int hand) { Push(b, hand, 60); }},
      {21, "60 N on a handle, Net F/T", kNetFt, kHold, 3,
       [](Bench& b, int hand) { Push(b, hand, 60); }},
      {23, "joint jumps by 0.2 rad", kUr, kPowerOff, 4,
       ToWire([](WireFaults* w) { ChangeUr(w, kSecondJointOfUr, Jump); })},
      {23, "joint jumps by 0.2 rad", kFranka, kPowerOff, 2,
       ToWire([](WireFaults* w) { ChangeFranka(w, kSecondJointOfFranka, Jump); })},
  };
}

std::vector<Fault> FaultsOfTheLoop() {
  using enum Carrier;
  using enum Expect;
  return {
      {24, "the simulation's state not a number", kLoop, kHold, 1,
       [](Bench&, int) { BreakPhysics(PhysicsFault::kNotANumber); }},
      {24, "the simulation diverges", kLoop, kHold, 1,
       [](Bench&, int) { BreakPhysics(PhysicsFault::kDiverges); }},
      {26, "the solver finds no solution", kLoop, kHold, 3,
       [](Bench&, int) { BreakQp(QpFault::kInfeasible); }},
      {26, "the solver gives a wrong solution", kLoop, kHold, 3,
       [](Bench&, int) { BreakQp(QpFault::kWrong); }},
      {26, "the solver's solution not a number", kLoop, kHold, 3,
       [](Bench&, int) { BreakQp(QpFault::kNotANumber); }},
      {27, "the solver comes to its limit of iterations", kLoop, kHold, 3,
       [](Bench&, int) { BreakQp(QpFault::kIterationLimit); }},
      {30, "one deadline missed", kLoop, kContinues, 0, [](Bench& b, int) { b.Tick(1); }},
      {30, "three deadlines missed", kLoop, kHold, 1, [](Bench& b, int) { b.Tick(3); }},
      // Every fiftieth deadline is missed, which is 2 % of the deadlines in a second. The limit of
      // 1 % is reached after half a second.
      {30, "each fiftieth deadline missed", kLoop, kHold, 1300,
       [](Bench& b, int) {
         for (int k = 0; k < 1300 && b.emulator().state() == RunState::kRun; ++k)
           b.Tick(k % 50 == 49 ? 1 : 0);
       }},
  };
}

// Returns the text from the catalogue without its first letter, which is a capital at the start of
// a sentence.
std::string Cause(StopCause cause, Quantity quantity = Quantity::kNone) {
  return StopCauseText(cause, quantity).substr(1);
}

}  // namespace

const std::vector<FaultWords>& AllFaultWords() {
  static constexpr const char* kLost = "lost in the last second";
  static const std::string kArmOld = Cause(StopCause::kStale, Quantity::kArmAge);
  static const std::string kSensorOld = Cause(StopCause::kStale, Quantity::kSensorAge);
  static constexpr const char* kDropped = "devices were dropped";
  static const std::string kBadReading = Cause(StopCause::kSensor);
  static const std::string kDiverged = Cause(StopCause::kPhysics);
  static const std::string kNoMotion = Cause(StopCause::kQp);
  static const std::string kLate = Cause(StopCause::kDeadline);
  static const std::string kForce = Cause(StopCause::kForce);
  static const std::vector<FaultWords> words = {
      {1, "", {kLost}},
      {2, "", {kArmOld}},
      {3, "arm", {kArmOld}},
      {3, "sensor", {kSensorOld}},
      {4, "states late by 1 ms", {"communication constraints violation"}},
      {5, "", {kLost}},
      {6, "the arm's last", {kArmOld}},
      {7, "a sensor", {"has restarted its counter, as after a reboot"}},
      {7, "an arm restarts its clock", {"has restarted its clock, as after a reboot"}},
      {7, "an arm restarts its numbering", {kArmOld}},
      {8, "sensor's datagrams cut", {kSensorOld}},
      {8, "datagrams from another sender", {kDropped}},
      {8, "a tenth", {kDropped}},
      {9, "", {"sends data that is not RTDE"}},
      {11, "half-open", {kArmOld}},
      {11, "connection closed", {"closed the connection"}},
      {12, "protective stop", {"is in protective stop"}},
      {12, "reflex", {"stopped by a reflex (cartesian reflex)"}},
      {13, "emergency stop", {"is in emergency stop", "the user stop or an emergency stop"}},
      {13, "user stop", {"the user stop or an emergency stop"}},
      {15, "", {Cause(StopCause::kOperator)}, false},
      {17, "joint", {"sends impossible joint angles or times"}},
      {17, "arm's own wrench", {kBadReading}},
      {18, "", {kBadReading}},
      {19, "", {Cause(StopCause::kStale, Quantity::kCount)}},
      {20, "", {"drifts by"}},
      {21, "", {kForce}},
      {22, "both", {Cause(StopCause::kRunaway), kForce, Cause(StopCause::kTorque)}, false},
      {23, "", {Cause(StopCause::kDevice, Quantity::kAngle)}},
      {24, "the simulation", {kDiverged}, false},
      {25, "", {Cause(StopCause::kOscillation)}, false},
      {26, "", {kNoMotion}, false},
      {27, "", {kNoMotion}, false},
      {30, "three", {kLate}, false},
      {30, "each fiftieth", {kLate}, false},
  };
  return words;
}

const FaultWords* WordsOf(const Fault& fault) {
  for (const FaultWords& words : AllFaultWords())
    if (words.number == fault.number && std::string(fault.name).starts_with(words.fault))
      return &words;
  return nullptr;
}

void FaultOutcome::SetMessage(const std::string& text) { Copy(text, &message); }

void FaultOutcome::Fail(const std::string& text) {
  if (well) Copy(text, &why);
  well = false;
}

const std::vector<FaultRig>& FaultRigs() {
  static const std::vector<FaultRig> rigs = {
      {"two UR", "dual_ur5", {"ur", "ur"}, {"net_ft", "net_ft"}},
      {"two Franka", "box_9kg", {"franka", "franka"}, {"", "net_ft"}},
      {"UR and Franka", "ur_and_panda", {"ur", "franka"}, {"", "net_ft"}}};
  return rigs;
}

std::vector<int> HandsWith(Carrier carrier, const FaultRig& rig) {
  std::vector<int> hands;
  for (std::size_t i = 0; i < kHands; ++i)
    if (Carries(carrier, rig.arms[i], rig.sensors[i])) hands.push_back(static_cast<int>(i));
  return hands;
}

bool HasSlowFranka(const FaultRig& rig, std::uint64_t seed) {
  return seed / 2 % 2 == 1 && !HandsWith(Carrier::kFranka, rig).empty();
}

BenchOptions OptionsOf(const FaultRig& rig, std::uint64_t seed) {
  BenchOptions options;
  options.scenario = PREDICTOR_SOURCE_DIR "/scenarios/" + std::string(rig.scenario) + ".yaml";
  for (std::size_t i = 0; i < kHands; ++i) {
    options.arms[i] = rig.arms[i];
    options.sensors[i] = rig.sensors[i];
  }
  options.seed = seed;
  const bool brisk = seed % 2 == 0;
  options.change = [rig, brisk, slow = HasSlowFranka(rig, seed)](Scenario* s) {
    if (brisk) s->operator_.script = BriskScript();
    for (const int hand : HandsWith(Carrier::kFranka, rig))
      if (!slow) MakeQuick(hand == 0 ? &s->device.left : &s->device.right);
  };
  return options;
}

Fault* FindFault(std::vector<Fault>* all, int number, const char* beginning) {
  for (Fault& fault : *all)
    if (fault.number == number && std::string(fault.name).starts_with(beginning)) return &fault;
  throw std::logic_error(std::string("no such fault: ") + beginning);
}

const std::vector<Fault>& Faults() {
  static const std::vector<Fault> faults = [] {
    std::vector<Fault> all;
    for (const auto& some : {FaultsOfWires(), FaultsOfDevices(), FaultsOfTheLoop(),
                             FaultsOfStarts(), FaultsOfProcesses(), FaultsOfScenes()})
      all.insert(all.end(), some.begin(), some.end());
    std::stable_sort(all.begin(), all.end(),
                     [](const Fault& a, const Fault& b) { return a.number < b.number; });
    return all;
  }();
  return faults;
}

}  // namespace predictor
