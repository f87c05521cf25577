// Displaces the object by `by`.
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"
#include "scenario/actions/transport.h"

namespace predictor::actions {

const ActionKind kMove = {
    .name = "move",
    .uses = {{{"duration"}, {"by", true}}},
    .motion = ActionMotion::kMoves,
    .sentence = [](const ActionSpec& s, int facing) { return MoveSentence(s.by, facing); },
    .make = [](const ActionSpec& s) -> std::unique_ptr<Action> {
      return std::make_unique<Transport>(s, s.by, Vector3::Zero());
    },
};

}  // namespace predictor::actions
