#include "core/loaded_hands.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/message_catalogue.h"
#include "core/words.h"

namespace predictor {

bool ArmAtFault(const HandRecord& hand) { return hand.present != 0 && hand.arm_fault != 0; }

bool ArmAtFault(const TickRecord& record) {
  return std::any_of(record.hands.begin(), record.hands.end(),
                     [](const HandRecord& hand) { return ArmAtFault(hand); });
}

bool NothingMovesAnyMore(const TickRecord& record) {
  return record.state == RunState::kUnpowered || ArmAtFault(record);
}

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
    if (hand.since == 0 || loaded != hand.loaded) hand = {record.tick, loaded, hand.reported};
    if (static_cast<double>(record.tick - hand.since) < patience_ || hand.reported == loaded)
      continue;
    hand.reported = loaded;
    if (!loaded) continue;
    const std::string caught =
        NothingMovesAnyMore(record)
            ? Message("danger.caught_free")
            : Message("danger.caught_recover", {{"hold", HowToHold('r', enabling_device_)}});
    words.push_back(Message(
        "danger.loaded",
        {{"side", kHandNames[i]}, {"force", Formatted("%.0f", force)}, {"caught", caught}}));
  }
  return words;
}

}  // namespace predictor
