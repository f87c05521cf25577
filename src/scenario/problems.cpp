#include "scenario/problems.h"

#include <algorithm>
#include <tuple>

#include "core/error.h"

namespace predictor {

void Problems::Add(const Place& place, const std::string& sentence) {
  ++count_;
  if (found_.size() < kMaxReported) found_.push_back({place, sentence});
}

void Problems::ThrowIfAny() {
  if (found_.empty()) return;
  std::stable_sort(found_.begin(), found_.end(), [](const Problem& a, const Problem& b) {
    return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
  });
  std::string text;
  for (const Problem& problem : found_) {
    if (!text.empty()) text += '\n';
    text += InputError(problem.place.Text(), problem.sentence).what();
  }
  if (count_ > found_.size()) {
    text += "\nAnd " + std::to_string(count_ - found_.size()) + " more.";
  }
  throw InputError(text);
}

}  // namespace predictor
