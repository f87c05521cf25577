// Displaces the object by `by`, and then opens the hands.
#include "scenario/actions/grip.h"
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"
#include "scenario/actions/transport.h"

namespace predictor::actions {
namespace {

struct PutDownParameters {
  double duration = 1;           // [s]
  Vector3 by = Vector3::Zero();  // displacement in W [m]
  std::string hand = "both";
};

template <class V>
void Fields(V& v, PutDownParameters& p) {
  v("duration", p.duration, DurationRule());
  v("by", p.by, Number("m", "intended displacement of the object, in W", Within(10)));
  v("hand", p.hand, HandRule());
}

class PutDown final : public Transport {
 public:
  explicit PutDown(const PutDownParameters& p)
      : Transport(p.duration, p.by, Vector3::Zero()), release_(p.hand, false, p.duration) {}
  bool Advance(double dt, double pace, Intent* intent) noexcept override {
    if (Transport::Advance(dt, pace, intent)) return true;
    release_.Begin(intent);
    return false;
  }
  static std::string Sentence(const PutDownParameters& p, double facing) {
    std::string text = MoveSentence(p.by, facing);
    if (text.rfind("Hold", 0) == 0) return "Put the object down.";
    text.pop_back();
    return text + " and put it down.";
  }

 private:
  Grip release_;
};

}  // namespace

const ActionKind kPutDown = ActionKindOf<PutDown, PutDownParameters>(
    "put_down", "displaces the object, then opens hands", ActionMotion::kMoves);

}  // namespace predictor::actions
