// Closes hands within `duration`.
#include "scenario/actions/grip.h"

#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

struct GripParameters {
  double duration = 1;  // [s]
  std::string hand = "both";
};

template <class V>
void Fields(V& v, GripParameters& p) {
  v("duration", p.duration, DurationRule());
  v("hand", p.hand, HandRule());
}

class Close final : public Grip {
 public:
  explicit Close(const GripParameters& p) : Grip(p.hand, true, p.duration) {}
  static std::string Sentence(const GripParameters& p, double) {
    return "Grip " + HandlesOf(p.hand) + ".";
  }
};

}  // namespace

const ActionKind kGrip = ActionKindOf<Close, GripParameters>("grip", "closes hands");

}  // namespace predictor::actions
