#include "analysis/check/contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "models/object_model.h"
#include "simulation/event_sequence.h"
#include "simulation/mujoco/contact_law.h"

namespace predictor {
namespace {

constexpr double kScanRatio = 1.6;  // of successive stiffnesses
constexpr double kPrecision = 1.05;
constexpr double kAtRest = 0.05;      // frequency that counts as rest [Hz]
constexpr double kSameNormal = 0.99;  // cosine of the angle between normals that count as equal
constexpr double kPoints = 4;         // where a flat face touches another

bool IsOfEngine(const Surface& surface) {
  return surface.kind == Surface::Kind::kTable || surface.kind == Surface::Kind::kFloor;
}

// Returns whether contacts with two surfaces have the same properties. Each movable object has its
// own mass.
bool IsSameKind(const Scenario& s, const Surface& one, const Surface& other) {
  if (IsOfEngine(one)) return IsOfEngine(other);
  if (one.kind != Surface::Kind::kFixture || other.kind != one.kind) return false;
  const FixtureSpec& a = s.environment.fixtures[one.number];
  const FixtureSpec& b = s.environment.fixtures[other.number];
  return a.stiffness == b.stiffness && a.damping == b.damping &&
         (a.stiffness ||
          (a.time_constant == b.time_constant && a.damping_ratio == b.damping_ratio));
}

// Returns the law of a contact in which the carried object has the effective mass `mass` [kg].
ContactLaw LawOf(const Scenario& s, const Surface& surface, double mass) {
  if (IsOfEngine(surface)) return LightContactLaw(mass);
  if (surface.kind == Surface::Kind::kFixture)
    return ContactLawOf(s.environment.fixtures[surface.number], mass);
  const double other = LoadMovable(s, surface.number).mass;
  return ContactLawOf(FixtureSpec(), mass * other / (mass + other));
}

// Predicts the loop at the surfaces of one scenario.
class ContactPrediction {
 public:
  ContactPrediction(const Scenario& s, const World& world, double lead)
      : s_(s),
        start_(world.Linearise()),
        world_(world.LineariseWithoutContacts()),
        support_(world.SupportAtStart()),
        lead_(lead) {}

  const LinearModel& world() const { return world_; }  // without contacts

  // The object touches all surfaces of `at` at the start, or none.
  ContactReport At(const ContactWall& at) const {
    ContactReport report{at};
    report.at_start = IsTouchedAtStart(at.surfaces[0]);
    report.what = PhraseOf(at.surfaces, &s_);
    report.stable = report.at_start ? IsStable(start_) : IsStableAt(report);
    report.limit = StiffestStableWall(world_, s_, s_.operator_.hand, lead_, report.Varying());
    const LinearModel touching = report.at_start ? start_ : WithWall(world_, report.wall);
    report.at_rest = Felt(touching, report.wall, kAtRest);
    report.moving = Felt(touching, report.wall, kFeltFrequency);
    for (const double frequency : FeltFrequencies())
      report.spectrum.push_back({frequency, Felt(touching, report.wall, frequency)});
    if (report.is_movable()) AddMasses(&report);
    return report;
  }

  bool IsTouchedAtStart(const Surface& surface) const {
    switch (surface.kind) {
      case Surface::Kind::kFixture:
        return (support_.fixtures >> surface.number & 1U) != 0;
      case Surface::Kind::kTable:
        return support_.touches_table;
      case Surface::Kind::kFloor:
        return support_.touches_floor;
      case Surface::Kind::kMovable:  // the program refuses such a start
        break;
    }
    return false;
  }

 private:
  bool IsStable(const LinearModel& world) const {
    return HapticLoop(world, s_, 1 / s_.rate).GrowthRate(s_.operator_.hand, lead_, 1) <=
           HapticLoop::kGrowing;
  }
  bool IsStable(Wall wall, const ContactLaw& law, double points) const {
    wall.stiffness = points * law.stiffness;
    wall.damping = points * law.damping;
    wall.inertia = points * law.inertia;
    return IsStable(WithWall(world_, wall));
  }
  bool IsStableAt(const ContactReport& report) const {
    const Wall& wall = report.wall;
    std::vector<ContactLaw> laws = {{wall.stiffness, wall.damping, wall.inertia}};
    const bool of_engine = IsOfEngine(report.surfaces[0]);
    if (of_engine) laws.push_back(DeepContactLaw(MassAt(world_, wall)));
    const bool is_soft = report.yields || of_engine;
    return std::ranges::all_of(laws, [&](const ContactLaw& law) {
      return IsStable(wall, law, 1) && (!is_soft || IsStable(wall, law, kPoints));
    });
  }

  FeltImpedance Felt(const LinearModel& world, const Wall& wall, double frequency) const {
    return ImpedanceAt(world, s_, lead_, 1 / s_.rate, wall.normal, frequency);
  }

  AddedMass WithMass(double mass, const Wall& wall, const std::vector<Vector3>& directions) const {
    LinearModel heavier = world_;
    for (const Vector3& direction : directions) {
      Wall inertia{wall.hand, wall.p_DC, direction};
      inertia.inertia = mass;
      heavier = WithWall(heavier, inertia);
    }
    return {mass, IsStable(heavier), Felt(heavier, wall, kFeltFrequency)};
  }

  // A held object adds its mass in all directions. Its moments of inertia are omitted.
  void AddMasses(ContactReport* report) const {
    const std::size_t i = report->surfaces[0].number;
    const double mass = LoadMovable(s_, i).mass;
    report->pushed = WithMass(mass, report->wall, {report->wall.normal});
    const EventSequence events(s_);
    for (std::size_t k = 0; k < events.size(); ++k)
      if (events.movable(k) == static_cast<int>(i))
        report->held =
            WithMass(mass, report->wall, {Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()});
  }

  const Scenario& s_;
  LinearModel start_, world_;  // with the contacts of the start, and without contacts
  ObjectSupport support_;
  double lead_;
};

}  // namespace

WallLimit StiffestStableWall(const LinearModel& world, const Scenario& scenario,
                             const HandSpec& hand, double lead, const Wall& wall, LoopModel model) {
  WallLimit limit;
  const auto is_stable = [&](double stiffness) {
    Wall varied = wall;
    varied.stiffness = stiffness;
    double frequency = 0;
    const HapticLoop loop(WithWall(world, varied), scenario, 1 / scenario.rate, model);
    const bool stable = loop.GrowthRate(hand, lead, 1, &frequency) <= HapticLoop::kGrowing;
    if (!stable) limit.frequency = frequency;
    return stable;
  };
  double stable = 0, unstable = kSoftestWall;
  while (is_stable(unstable)) {
    stable = unstable;
    if (stable >= kStiffestWall) return {kStiffestWall, 0, false};
    unstable = std::min(kScanRatio * unstable, kStiffestWall);
  }
  if (stable == 0) return limit;
  while (unstable > kPrecision * stable) {
    const double middle = std::sqrt(stable * unstable);
    (is_stable(middle) ? stable : unstable) = middle;
  }
  limit.stiffness = stable;
  return limit;
}

Wall ContactWall::Varying() const {
  Wall varying = wall;
  varying.inertia = 0;
  if (!yields) varying.damping = 0;
  return varying;
}

std::vector<double> FeltFrequencies() {
  constexpr double kLowest = 0.1, kHighest = 40, kPerDecade = 20;
  std::vector<double> frequencies;
  for (int k = 0; frequencies.empty() || frequencies.back() < kHighest; ++k)
    frequencies.push_back(std::min(kHighest, kLowest * std::pow(10, k / kPerDecade)));
  return frequencies;
}

double DampingOf(const std::complex<double>& impedance, double frequency) {
  return impedance.imag() / (2 * std::numbers::pi * frequency);
}

std::vector<ContactWall> WallsOf(const Scenario& s, const LinearModel& world, const Pose& X_WO,
                                 bool floor) {
  std::vector<ContactWall> walls;
  if (s.hands().count() == 0) return walls;
  Wall wall;
  wall.hand = *s.hands().begin();
  wall.p_DC = X_WO.p - X_WO * HandlePose(s, wall.hand).p;
  for (const Surface& surface : SurfacesOf(s, floor)) {
    wall.normal = NormalToward(s, surface, X_WO.p);
    const auto same = std::ranges::find_if(walls, [&](const ContactWall& w) {
      return w.wall.normal.dot(wall.normal) > kSameNormal && IsSameKind(s, w.surfaces[0], surface);
    });
    if (same != walls.end()) {
      same->surfaces.push_back(surface);
      continue;
    }
    const ContactLaw law = LawOf(s, surface, MassAt(world, wall));
    wall.stiffness = law.stiffness, wall.damping = law.damping, wall.inertia = law.inertia;
    const bool yields = surface.kind == Surface::Kind::kFixture &&
                        s.environment.fixtures[surface.number].stiffness.has_value();
    walls.push_back({{surface}, wall, yields});
  }
  return walls;
}

std::vector<ContactReport> CheckContacts(const Scenario& s, const World& world, double lead,
                                         bool floor) {
  std::vector<ContactReport> reports;
  const ContactPrediction prediction(s, world, lead);
  for (const ContactWall& at : WallsOf(s, prediction.world(), world.state().object.X_W, floor)) {
    // Equal surfaces share a report only if the object touches both of them at the start, or
    // neither.
    for (const bool touched : {true, false}) {
      ContactWall part = at;
      std::erase_if(part.surfaces, [&](const Surface& surface) {
        return prediction.IsTouchedAtStart(surface) != touched;
      });
      if (!part.surfaces.empty()) reports.push_back(prediction.At(part));
    }
  }
  return reports;
}

}  // namespace predictor
