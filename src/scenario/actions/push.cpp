// Adds a feed-forward force that rises within `rise_time`, is constant for `duration` and falls
// within `rise_time`.
#include <algorithm>
#include <array>

#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

struct PushParameters {
  double duration = 1;              // [s]
  Vector3 force = Vector3::Zero();  // force in W [N]
  double rise_time = 0.120;         // [s]
  std::string hand = "both";
};

template <class V>
void Fields(V& v, PushParameters& p) {
  v("duration", p.duration, DurationRule("time for which the force is constant"));
  v("force", p.force, Required(Number("N", "feed-forward force of each hand, in W", Within(1000))));
  v("rise_time", p.rise_time,
    Number("s", "time in which the force rises, and in which it falls", Above(0, 10)));
  v("hand", p.hand, HandRule());
}

class Push final : public Action {
 public:
  explicit Push(const PushParameters& p)
      : concerns_{Concerns(p.hand, 0), Concerns(p.hand, 1)},
        force_(NotZero("force", p.force)),
        rise_(std::max(p.rise_time, 1e-9)),
        total_(Time(p)) {}
  static double Time(const PushParameters& p) { return 2 * p.rise_time + p.duration; }
  static std::string Sentence(const PushParameters& p, double facing) {
    const std::string where = DirectionWords(p.force.normalized(), facing);
    return "Push " + HandlesOf(p.hand) + (where.empty() ? "" : " " + where) + " with " +
           WithUnit(p.force.norm(), " N") + ".";
  }
  void Begin(Intent*) noexcept override { time_ = 0; }
  bool Advance(double dt, double, Intent* intent) noexcept override {
    time_ += dt;
    const double part = std::clamp(std::min(time_, total_ - time_) / rise_, 0.0, 1.0);
    for (std::size_t i = 0; i < kHands; ++i)
      if (concerns_[i]) intent->push[i] += part * force_;
    return time_ < total_;
  }
  void Archive(StateArchive& a) noexcept override { a(time_); }

 private:
  std::array<bool, kHands> concerns_;
  Vector3 force_;        // force in W [N]
  double rise_, total_;  // [s]
  double time_ = 0;      // [s]
};

}  // namespace

const ActionKind kPush = ActionKindOf<Push, PushParameters>("push", "adds a force of the hands");

}  // namespace predictor::actions
