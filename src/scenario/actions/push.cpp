// Adds a feed-forward force: it rises within `rise`, stays for `duration`, falls within `rise`.
#include <algorithm>

#include "core/error.h"
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

double PushTime(const ActionSpec& spec) noexcept { return 2 * spec.rise + spec.duration; }

class Push final : public Action {
 public:
  explicit Push(const ActionSpec& spec)
      : concerns_{Concerns(spec, 0), Concerns(spec, 1)},
        force_(spec.force),
        rise_(std::max(spec.rise, 1e-9)),
        total_(PushTime(spec)) {}
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
  Vector3 force_;        // in W [N]
  double rise_, total_;  // [s]
  double time_ = 0;      // [s]
};

}  // namespace

const ActionKind kPush = {
    .name = "push",
    .uses = {{{"duration"}, {"force", true}, {"rise"}, {"hand"}}},
    .sentence =
        [](const ActionSpec& s, int) {
          return "Push " + HandlesOf(s.hand) + " with " + WithUnit(s.force.norm(), " N") + ".";
        },
    .make = [](const ActionSpec& s) -> std::unique_ptr<Action> {
      if (s.rise < 0) throw InputError("The rise of a push cannot be negative.");
      return std::make_unique<Push>(s);
    },
    .time = PushTime,
};

}  // namespace predictor::actions
