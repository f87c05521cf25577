#include "rig/script.h"

#include <algorithm>

namespace predictor {

Script::Script(const std::vector<ActionSpec>& specs) {
  for (int i = 0; i < static_cast<int>(specs.size()); ++i) {
    const ActionSpec& spec = specs[static_cast<std::size_t>(i)];
    entries_.push_back({spec.start, i, MakeAction(spec, i)});
  }
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.start < b.start; });
}

void Script::Reset() noexcept {
  for (Entry& entry : entries_) entry.begun = entry.active = false;
}

void Script::Begin(double run_time, Intent* intent) noexcept {
  for (Entry& entry : entries_) {
    if (entry.begun || entry.start > run_time) continue;
    entry.action->Begin(intent);
    entry.begun = entry.active = true;
  }
}

void Script::Advance(double dt, double pace, Intent* intent) noexcept {
  for (Entry& entry : entries_) {
    if (!entry.active) continue;
    const bool pointless = entry.action->NeedsHold() && !intent->AnyHold();
    entry.active = !pointless && entry.action->Advance(dt, pace, intent);
  }
}

int Script::current() const noexcept {
  int index = -1;
  for (const Entry& entry : entries_) {
    if (entry.active) index = entry.index;
  }
  return index;
}

}  // namespace predictor
