#include "haptics/stability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "core/linear_algebra.h"

namespace predictor {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSmallestGain = 1.0 / 16;
constexpr double kPrecision = 1.02;

// An all-pass section (s² − b s + c)/(s² + b s + c), or (b − s)/(b + s) if c is 0. The times are in
// units of the delay to which the section belongs.
struct AllPass {
  double b, c;
};

// Returns identical first-order sections, (1 − sT/2n)ⁿ/(1 + sT/2n)ⁿ.
std::vector<AllPass> EqualSections(int order) {
  return std::vector<AllPass>(static_cast<std::size_t>(order), {2.0 * order, 0});
}

// Returns the Padé approximation of e^−sT with an even order n. The phase error of the
// approximation is below 0.01 rad up to |sT| = 3.7 (n = 4), 6.4 (n = 6) and 12 (n = 10). The
// denominator is Σ c_k (sT)^k with c_k = (2n − k)! n! / ((2n)! k! (n − k)!).
std::vector<AllPass> PadeSections(int order) {
  const double scale = order;  // scale of the roots, so that the matrix entries have similar
                               // magnitudes
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(order, order);
  double c = 1;  // c_k / c_n · scale^(k − n)
  for (int k = order - 1; k >= 0; --k) {
    c *= (2.0 * order - k) * (k + 1) / ((order - k) * scale);
    companion(k, order - 1) = -c;
    if (k > 0) companion(k, k - 1) = 1;
  }
  std::vector<AllPass> sections;
  for (const std::complex<double>& root : EigenvaluesOf(companion))
    if (root.imag() > 0)
      sections.push_back({-2 * scale * root.real(), scale * scale * std::norm(root)});
  return sections;
}

// A linear system that is built step by step. A signal is a row vector that contains the weights of
// the states.
class System {
 public:
  using Signal = Eigen::RowVectorXd;

  explicit System(int capacity) : A_(Eigen::MatrixXd::Zero(capacity, capacity)) {}

  int AddState() { return states_++; }
  Signal State(int i) const { return Signal::Unit(A_.cols(), i); }
  Signal Zero() const { return Signal::Zero(A_.cols()); }
  void SetDerivative(int state, const Signal& value) { A_.row(state) = value; }
  void AddDerivative(int state, const Signal& value) { A_.row(state) += value; }

  // Applies a first-order low-pass with this cutoff [rad/s].
  Signal LowPass(const Signal& input, double cutoff) {
    const int z = AddState();
    SetDerivative(z, cutoff * (input - State(z)));
    return State(z);
  }

  // Applies a delay [s] with all-pass sections. Adds as many states as the total order of the
  // sections.
  Signal Delay(Signal input, double delay, const std::vector<AllPass>& sections) {
    if (delay <= 0) return input;
    for (const AllPass& section : sections) {
      if (section.c == 0) {  // first order
        input = 2 * LowPass(input, section.b / delay) - input;
        continue;
      }
      const double b = section.b / delay, w = std::sqrt(section.c) / delay;
      const int z1 = AddState(), z2 = AddState();
      SetDerivative(z1, w * State(z2));
      SetDerivative(z2, b * (input - State(z2)) - w * State(z1));
      input -= 2 * State(z2);
    }
    return input;
  }

  Eigen::MatrixXd Matrix() const { return A_.topLeftCorner(states_, states_); }

 private:
  Eigen::MatrixXd A_;
  int states_ = 0;
};

int OrderOf(const std::vector<AllPass>& sections) {
  int order = 0;
  for (const AllPass& section : sections) order += section.c == 0 ? 1 : 2;
  return order;
}

}  // namespace

// Models of the delays in the loop.
struct LoopDelays {
  std::vector<AllPass> arm;  // arm and sensor, a few milliseconds
  std::vector<AllPass> reflex, sight;
  double reserve;  // [ticks]

  // Returns the number of states per axis of one hand, which belong to handle position, lead
  // filter, loop delay, arm loop, reflex, sight and sensor.
  int StatesPerAxis() const {
    return 1 + 1 + OrderOf(arm) + 2 + OrderOf(reflex) + OrderOf(sight) + 1;
  }
};

namespace {

const LoopDelays& DelaysOf(LoopModel model) {
  static const LoopDelays kWithReserve = {EqualSections(2), EqualSections(3), EqualSections(4),
                                          1.5};
  static const LoopDelays kExact = {PadeSections(4), PadeSections(10), PadeSections(6), 0};
  return model == LoopModel::kExact ? kExact : kWithReserve;
}

// Motion of a real handle along one axis.
struct HandleAxis {
  System::Signal position, velocity, acceleration;
};

// Adds the real handle, which follows the motion of the virtual handle.
HandleAxis AddArm(System* s, const ArmSpec& arm, const RenderingSpec& rendering,
                  const LoopDelays& delays, double lead, bool turn, double dt,
                  const System::Signal& x_d, const System::Signal& v_d) {
  const int h = s->AddState();
  const double lead_cutoff = HapticLoop::LeadCutoff(rendering, dt);
  const System::Signal a_d = lead_cutoff * (v_d - s->LowPass(v_d, lead_cutoff));
  const double gain = turn ? rendering.ko / 2 : rendering.kp;  // (9) uses half the angle
  const System::Signal command = v_d + lead * a_d + gain * (x_d - s->State(h));
  // This value is the sum of all pure delays in the loop. The hold of the force adds half a tick,
  // but the virtual handles are half a tick ahead of the sample. These two effects cancel each
  // other.
  const double delay = arm.loop.delay + arm.sensor.delay + delays.reserve * dt;
  const System::Signal u = s->Delay(command, delay, delays.arm);
  const int v = s->AddState();
  const int a = s->AddState();
  const double w = 2 * kPi * arm.loop.bandwidth;
  s->SetDerivative(h, s->State(v));
  s->SetDerivative(v, s->State(a));
  s->SetDerivative(a, w * w * (u - s->State(v)) - 2 * arm.loop.damping_ratio * w * s->State(a));
  return {s->State(h), s->State(v), s->State(a)};
}

// Adds the hand's reaction to the handle's motion along one axis (0–2 translation, 3–5 rotation).
// `seen` is the displacement of the object along this axis. The operator sees this displacement,
// and the hand corrects it.
System::Signal AddHand(System* s, const HandSpec& hand, const LoopDelays& delays, int axis,
                       const HandleAxis& handle, const System::Signal& seen) {
  const bool turn = axis >= 3;
  const double stiffness = turn ? hand.rotation_stiffness : hand.stiffness[axis];
  const double damping =
      turn ? hand.rotation_damping : 2 * hand.damping_ratio * std::sqrt(hand.mass * stiffness);
  const System::Signal effort = stiffness * handle.position + damping * handle.velocity;
  System::Signal force =
      -effort - hand.reflex_gain * s->Delay(effort, hand.reflex_delay, delays.reflex);
  if (turn) return force;
  force -= hand.mass * handle.acceleration;
  if (hand.visual_stiffness[axis] > 0)
    force -= hand.visual_stiffness[axis] * s->Delay(seen, hand.visual_delay, delays.sight);
  return force;
}

}  // namespace

double HapticLoop::Lag(const VelocityLoopSpec& loop, double dt) {
  return 2 * loop.damping_ratio / (2 * kPi * loop.bandwidth) + loop.delay - dt / 2;
}

double HapticLoop::LeadCutoff(const RenderingSpec& rendering, double dt) {
  return rendering.lead_cutoff > 0 ? 2 * kPi * rendering.lead_cutoff : 2 / dt;
}

HapticLoop::HapticLoop(const LinearModel& world, const Scenario& scenario, double dt,
                       LoopModel model)
    : world_(world), scenario_(scenario), dt_(dt), delays_(DelaysOf(model)) {}

double HapticLoop::GrowthRate(const HandSpec& hand, double lead, double gain,
                              double* frequency) const {
  const int n = static_cast<int>(world_.A.rows());
  const int nv = world_.dof;  // states: positions, velocities, and those of the controller
  System s(n + 12 * delays_.StatesPerAxis());
  for (int i = 0; i < n; ++i) s.AddState();
  const auto of_world = [&](const Eigen::RowVectorXd& row) {
    System::Signal signal = s.Zero();
    signal.head(n) = row;
    return signal;
  };
  for (int i = 0; i < n; ++i) s.SetDerivative(i, of_world(world_.A.row(i)));
  std::array<std::array<HandleAxis, 6>, kHands> handles;
  std::array<System::Signal, 6> object;  // motion of the object: the mean of its handles
  object.fill(s.Zero());
  const double share = 1.0 / scenario_.hands().count();
  for (const int i : scenario_.hands()) {
    for (int axis = 0; axis < 6; ++axis) {
      // The matrix that maps velocities to a handle's twist also maps positions to its
      // displacement.
      const Eigen::RowVectorXd twist = world_.C.row(6 * i + axis);
      Eigen::RowVectorXd displacement = Eigen::RowVectorXd::Zero(n);
      displacement.head(nv) = twist.segment(nv, nv);
      handles[i][axis] = AddArm(&s, scenario_.arm(i), scenario_.rendering, delays_, lead, axis >= 3,
                                dt_, of_world(displacement), of_world(twist));
      object[axis] += share * handles[i][axis].position;
    }
  }
  for (const int i : scenario_.hands()) {
    for (int axis = 0; axis < 6; ++axis) {
      System::Signal force =
          gain * AddHand(&s, hand, delays_, axis, handles[i][axis], object[axis]);
      const double low_pass = scenario_.arm(i).sensor.cutoff_frequency;
      if (low_pass > 0) force = s.LowPass(force, 2 * kPi * low_pass);
      for (int k = 0; k < n; ++k) s.AddDerivative(k, world_.B(k, 6 * i + axis) * force);
    }
  }
  const Eigen::VectorXcd modes = EigenvaluesOf(s.Matrix());
  Eigen::Index worst = 0;
  modes.real().maxCoeff(&worst);
  if (frequency) *frequency = std::abs(modes[worst].imag()) / (2 * kPi);
  return modes[worst].real();
}

bool HapticLoop::IsStable(const HandSpec& hand, double lead, double gain,
                          StabilityMargin* margin) const {
  double frequency = 0;
  if (GrowthRate(hand, lead, gain, &frequency) <= kGrowing) return true;
  margin->frequency = frequency;
  return false;
}

StabilityMargin HapticLoop::Margin(const HandSpec& hand, double lead) const {
  StabilityMargin margin;
  double stable = 0;
  double unstable = 0;
  if (IsStable(hand, lead, 1, &margin)) {
    for (stable = 1; unstable == 0;) {
      if (stable >= kLargestGain) return {kLargestGain, 0};
      if (IsStable(hand, lead, 2 * stable, &margin))
        stable *= 2;
      else
        unstable = 2 * stable;
    }
  } else {
    for (unstable = 1; stable == 0;) {
      if (unstable <= kSmallestGain) return margin;
      if (IsStable(hand, lead, unstable / 2, &margin))
        stable = unstable / 2;
      else
        unstable /= 2;
    }
  }
  while (unstable > kPrecision * stable) {
    const double middle = std::sqrt(stable * unstable);
    (IsStable(hand, lead, middle, &margin) ? stable : unstable) = middle;
  }
  margin.gain = stable;
  return margin;
}

LeadChoice ChooseLead(const HapticLoop& loop, const Scenario& scenario, double dt, double margin) {
  LeadChoice choice;
  for (int i = 0; i < kHands; ++i)
    if (scenario.Has(i))
      choice.lag = std::max(choice.lag, HapticLoop::Lag(scenario.arm(i).loop, dt));
  const HandSpec& hand = scenario.operator_.hand;
  if (scenario.rendering.lead) {
    choice.lead = *scenario.rendering.lead;
    choice.margin = loop.Margin(hand, choice.lead);
    return choice;
  }
  constexpr int kSteps = 5;
  for (int k = kSteps; k >= 0; --k) {
    const double lead = choice.lag * k / kSteps;
    // The loop must be stable with the nominal impedance of the hands, and also if the margin
    // increases this impedance.
    if (loop.GrowthRate(hand, lead, margin) > HapticLoop::kGrowing ||
        loop.GrowthRate(hand, lead, 1) > HapticLoop::kGrowing)
      continue;
    choice.lead = lead;
    choice.margin = loop.Margin(hand, lead);
    return choice;
  }
  for (int k = kSteps; k >= 0; --k) {
    const StabilityMargin m = loop.Margin(hand, choice.lag * k / kSteps);
    if (m.gain <= choice.margin.gain) continue;
    choice.lead = choice.lag * k / kSteps;
    choice.margin = m;
  }
  return choice;
}

}  // namespace predictor
