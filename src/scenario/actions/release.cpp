// Opens hands. The time that the release takes is a property of the hand
// (operator.hand.release_time).
#include "scenario/actions/grip.h"
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

constexpr double kTime = 1.0;  // time for which the instruction is shown [s]

struct ReleaseParameters {
  std::string hand = "both";
};

template <class V>
void Fields(V& v, ReleaseParameters& p) {
  v("hand", p.hand, HandRule());
}

class Open final : public Grip {
 public:
  explicit Open(const ReleaseParameters& p) : Grip(p.hand, false, kTime) {}
  static double Time(const ReleaseParameters&) { return kTime; }
  static std::string Sentence(const ReleaseParameters& p, double) {
    return "Let go of " + HandlesOf(p.hand) + ".";
  }
};

}  // namespace

const ActionKind kRelease = ActionKindOf<Open, ReleaseParameters>("release", "opens hands");

}  // namespace predictor::actions
