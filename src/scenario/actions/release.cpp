// Opens hands. The speed of release is a property of the hand (operator.hand.release_time).
#include "scenario/actions/grip.h"
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

constexpr double kTime = 1.0;  // time for which the instruction is shown [s]

}  // namespace

const ActionKind kRelease = {
    .name = "release",
    .uses = {{{"hand"}}},
    .sentence = [](const ActionSpec& s, int) { return "Let go of " + HandlesOf(s.hand) + "."; },
    .make = [](const ActionSpec& s) -> std::unique_ptr<Action> {
      return std::make_unique<Grip>(s, false, kTime);
    },
    .time = [](const ActionSpec&) noexcept { return kTime; },
};

}  // namespace predictor::actions
