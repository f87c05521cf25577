// Displaces the object by `by`, then opens hands.
#include "scenario/actions/grip.h"
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"
#include "scenario/actions/transport.h"

namespace predictor::actions {
namespace {

class PutDown final : public Transport {
 public:
  explicit PutDown(const ActionSpec& spec)
      : Transport(spec, spec.by, Vector3::Zero()), release_(spec, false, spec.duration) {}
  bool Advance(double dt, double pace, Intent* intent) noexcept override {
    if (Transport::Advance(dt, pace, intent)) return true;
    release_.Begin(intent);
    return false;
  }

 private:
  Grip release_;
};

std::string PutDownSentence(const ActionSpec& spec, int facing) {
  std::string text = MoveSentence(spec.by, facing);
  if (text.rfind("Hold", 0) == 0) return "Put the object down.";
  text.pop_back();
  return text + " and put it down.";
}

}  // namespace

const ActionKind kPutDown = {
    .name = "put_down",
    .uses = {{{"duration"}, {"by"}, {"hand"}}},
    .motion = ActionMotion::kMoves,
    .sentence = PutDownSentence,
    .make = [](const ActionSpec& s) -> std::unique_ptr<Action> {
      return std::make_unique<PutDown>(s);
    },
};

}  // namespace predictor::actions
