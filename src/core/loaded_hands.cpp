#include "core/loaded_hands.h"

#include <cmath>

#include "core/format.h"

namespace predictor {

std::vector<std::string> LoadedHands::See(const TickRecord& record) {
  std::vector<std::string> words;
  if (record.state != RunState::kHeld && record.state != RunState::kUnpowered) {
    hands_ = {};
    return words;
  }
  for (std::size_t i = 0; i < kHands; ++i) {
    const auto& F = record.hands[i].wrench;
    const double force = std::hypot(F[0], F[1], F[2]);
    const bool loaded = record.hands[i].present && force > force_;
    Hand& hand = hands_[i];
    if (hand.since == 0 || loaded != hand.loaded) hand = {record.tick, loaded, hand.told};
    if (static_cast<double>(record.tick - hand.since) < patience_ || hand.told == loaded) continue;
    hand.told = loaded;
    if (!loaded) continue;
    words.push_back(Formatted("Something presses on the %s handle with %.0f N. Let go of it; ",
                              kHandNames[i], force) +
                    (record.state == RunState::kHeld
                         ? "if a hand is caught, hold r: the handle then goes where it is pressed "
                           "to."
                         : "if a hand is caught, free it by the robot's own means (free-drive or "
                           "brake release, at its panel): this program moves nothing now."));
  }
  return words;
}

}  // namespace predictor
