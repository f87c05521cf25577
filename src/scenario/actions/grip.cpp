// Closes hands within `duration`.
#include "scenario/actions/grip.h"

#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"

namespace predictor::actions {

const ActionKind kGrip = {
    .name = "grip",
    .uses = {{{"duration"}, {"hand"}}},
    .sentence = [](const ActionSpec& s, int) { return "Grip " + HandlesOf(s.hand) + "."; },
    .make = [](const ActionSpec& s) -> std::unique_ptr<Action> {
      return std::make_unique<Grip>(s, true, s.duration);
    },
};

}  // namespace predictor::actions
