#include "analysis/check/start.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/text.h"
#include "core/units.h"
#include "models/last_link.h"

namespace predictor {
namespace {

constexpr double kTouching = 0.002;  // smaller overlaps are contacts [m]
constexpr double kCarried = 0.01;  // share of the weight below which a support is a rounding error

bool Overlaps(const LinkGap& gap) { return gap.distance < -kTouching; }

std::string Millimetres(double length) { return Formatted("%.0f mm", kMillimetres * length); }

std::string NameOfOther(const ContactPair& pair) {
  return pair.other.empty() ? "the object" : pair.other;
}

// Appends the pairs that can touch: one line for the object, and one for each link that can touch
// other links.
void AddPossibleContacts(const std::vector<ContactPair>& pairs, std::string* text) {
  std::vector<std::pair<std::string, std::string>> lines;  // a body, and what it can touch
  const ContactPair* nearest = nullptr;
  for (const ContactPair& pair : pairs) {
    if (pair.state != PairState::kCanTouch) continue;
    if (!nearest || pair.distance < nearest->distance) nearest = &pair;
    const bool with_object = pair.other.empty();
    const std::string body = with_object ? NameOfOther(pair) : pair.link;
    const std::string& partner = with_object ? pair.link : pair.other;
    const auto line = std::ranges::find(lines, body, &std::pair<std::string, std::string>::first);
    if (line == lines.end())
      lines.emplace_back(body, partner);
    else
      line->second += ", " + partner;
  }
  for (const auto& [body, partners] : lines)
    AppendLine(text, "  cobot.touches    %s can touch %s", body.c_str(), partners.c_str());
  if (nearest)
    AppendLine(text, "  nearest pair     %s and %s, %s%s apart", nearest->link.c_str(),
               NameOfOther(*nearest).c_str(), nearest->distance < kFarthestPair ? "" : "at least ",
               Millimetres(nearest->distance).c_str());
}

// Appends the pairs that cannot touch for one reason.
void AddExcludedPairs(const std::vector<ContactPair>& pairs, PairState state, const char* reason,
                      std::string* text) {
  std::string names;
  for (const ContactPair& pair : pairs) {
    if (pair.state != state) continue;
    names += (names.empty() ? "" : ", ") + pair.link + " and " + NameOfOther(pair);
    if (state == PairState::kOverlaps && pair.distance < 0)
      names += " (by " + Millimetres(-pair.distance) + " at the start)";
  }
  if (!names.empty()) AppendLine(text, "  no contact       %s: %s", reason, names.c_str());
}

void AddPairs(const std::vector<ContactPair>& pairs, std::string* text) {
  AddPossibleContacts(pairs, text);
  AddExcludedPairs(pairs, PairState::kOverlaps,
                   "overlap, or less than 1 mm apart, at cobot.posture", text);
  AddExcludedPairs(pairs, PairState::kJoint, "connected by a joint", text);
  AddExcludedPairs(pairs, PairState::kOneBody, "rigidly connected", text);
  AddExcludedPairs(pairs, PairState::kHolds, "hand and what it holds", text);
}

bool RestsOn(double force, const StartReport& start) { return force > kCarried * start.weight; }

}  // namespace

double StartReport::tilt() const { return std::acos(std::clamp(-outward.z(), -1.0, 1.0)); }

StartReport DescribeStart(const Scenario& s, const RobotModel& cobot, const World& world) {
  const WorldState& state = world.state();
  const Pose& X_WE = state.end_effector.X_W;
  const Pose& X_WO = state.object.X_W;
  StartReport start;
  start.flange = X_WE.p;
  start.outward = X_WE.q * LastLinkDirection(cobot, cobot.Frame(s.cobot.end_effector));
  start.is_outside = (X_WO.p - X_WE.p).dot(start.outward) > 0;
  start.gaps = LinkGaps(s).At(state.q, X_WO);
  start.support = world.SupportAtStart();
  start.weight = world.object_mass() * s.environment.gravity;
  start.pairs = world.contact_pairs();
  for (std::size_t i = 0; i < s.environment.fixtures.size(); ++i)
    if (s.environment.fixtures[i].keep_out) start.keep_out.push_back(i);
  return start;
}

std::vector<std::string> StartWarnings(const StartReport& start) {
  std::vector<std::string> warnings;
  const auto inside = [&](const LinkGap& gap, const char* why) {
    warnings.push_back(Formatted(
        "At the start, the object overlaps the cobot's link %s by %s%s. No contact acts between "
        "the object and this link, so the run would be possible only in the simulation. Choose "
        "another cobot.posture, or place the object further away from the link with "
        "object.attachment.on_end_effector.",
        gap.link.c_str(), Millimetres(-gap.distance).c_str(), why));
  };
  if (Overlaps(start.gaps.links)) inside(start.gaps.links, "");
  if (!start.is_outside && Overlaps(start.gaps.hand))
    inside(start.gaps.hand, ", because it is on the inner side of the end-effector");
  if (RestsOn(start.support.floor, start))
    warnings.push_back(
        Formatted("At the start, the object rests on the floor, which carries %.0f N of its weight "
                  "of %.0f N. The cobot carries only the rest, so a person must lift more. Choose "
                  "a higher cobot.posture, or raise cobot.base.",
                  start.support.floor, start.weight));
  return warnings;
}

void AddStart(const StartReport& start, std::string* text) {
  const auto list = [](const Vector3& v) {
    // Adding 0 turns a rounded -0 into 0.
    const auto shown = [](double x) { return std::round(100 * x) / 100 + 0.0; };
    return Formatted("[%.2f, %.2f, %.2f]", shown(v.x()), shown(v.y()), shown(v.z()));
  };
  AppendLine(text,
             "  flange           at %s m; the last link points along %s, %.0f° from straight "
             "down",
             list(start.flange).c_str(), list(start.outward).c_str(), kDegrees * start.tilt());
  const LinkGap& gap = start.gaps.links;
  if (!gap.link.empty() && gap.distance >= 0)
    AppendLine(text, "  object to cobot  %s to the nearest link that does not hold it (%s)",
               Millimetres(gap.distance).c_str(), gap.link.c_str());
  else if (!gap.link.empty())
    AppendLine(text, "  object to cobot  overlaps link %s by %s", gap.link.c_str(),
               Millimetres(-gap.distance).c_str());
  AddPairs(start.pairs, text);
  for (const std::size_t i : start.keep_out)
    AppendLine(text, "  keep-out volume  fixture %zu; only the cobot's links collide with it", i);
  if (RestsOn(start.support.floor, start))
    AppendLine(text, "  floor            the object rests on it; it carries %.0f of %.0f N",
               start.support.floor, start.weight);
  if (RestsOn(start.support.other, start))
    AppendLine(text,
               "  table            the object rests on it or on a fixture; they carry %.0f of "
               "%.0f N",
               start.support.other, start.weight);
}

}  // namespace predictor
