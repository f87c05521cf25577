// Keeps the object in place for `duration`.
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

struct HoldParameters {
  double duration = 1;  // [s]
};

template <class V>
void Fields(V& v, HoldParameters& p) {
  v("duration", p.duration, DurationRule());
}

class Hold final : public Action {
 public:
  explicit Hold(const HoldParameters& p) : duration_(p.duration) {}
  static std::string Sentence(const HoldParameters&, double) { return "Hold the object still."; }
  void Begin(Intent*) noexcept override { left_ = duration_; }
  bool Advance(double dt, double, Intent*) noexcept override { return (left_ -= dt) > 0; }
  void Archive(StateArchive& a) noexcept override { a(left_); }

 private:
  double duration_, left_ = 0;  // [s]
};

}  // namespace

const ActionKind kHold = ActionKindOf<Hold, HoldParameters>("hold", "keeps the object in place");

}  // namespace predictor::actions
