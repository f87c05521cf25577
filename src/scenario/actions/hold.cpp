// Keeps the object in place for `duration`.
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

class Hold final : public Action {
 public:
  explicit Hold(const ActionSpec& spec) : duration_(spec.duration) {}
  void Begin(Intent*) noexcept override { left_ = duration_; }
  bool Advance(double dt, double, Intent*) noexcept override { return (left_ -= dt) > 0; }
  void Archive(StateArchive& a) noexcept override { a(left_); }

 private:
  double duration_, left_ = 0;  // [s]
};

}  // namespace

const ActionKind kHold = {
    .name = "hold",
    .uses = {{{"duration"}}},
    .sentence = [](const ActionSpec&, int) { return std::string("Hold the object still."); },
    .make = [](const ActionSpec& s) -> std::unique_ptr<Action> {
      return std::make_unique<Hold>(s);
    },
};

}  // namespace predictor::actions
