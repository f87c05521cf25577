// Writes the page and the text of a stability map.
#include "report/page.h"

#include <string>

#include "analysis/stability_map/stability_map.h"
#include "analysis/stability_map/wall_map.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor {
namespace {

std::string Shown(const MapAxisText& text, double value) {
  return Formatted("%.3g %s", text.per_si * value, text.unit);
}

// Describes the agreement in one or two sentences.
std::string Verdict(const StabilityMap& map) {
  const MapAgreement a = AgreementOf(map);
  std::string text;
  if (a.held > 0) {
    text = Formatted(
        "Where the prediction's assumptions hold, %d of %d simulated boundaries are within 20 %% "
        "of the predicted ones",
        a.held_agree, a.held);
    text += Formatted(" (the largest deviation is %.2f times the predicted stiffness). ",
                      a.worst_ratio);
  } else {
    text = "No simulated boundary can be compared with the prediction. ";
  }
  if (a.one_sided > 0)
    text += Formatted(
        "In %d cases, only the prediction or only the simulation has a boundary within the "
        "searched range. ",
        a.one_sided);
  if (a.other > 0)
    text += Formatted(
        "In %d more cases, the assumptions of the prediction do not hold. In %d of these cases, "
        "the deviation is nevertheless below 20 %%. ",
        a.other, a.other_agree);
  return text;
}

std::string HandInWords(const StabilityMap& map) {
  const HandSpec& h = map.base.scenario.operator_.hand;
  return Formatted(
      "%.3g kg, %.3g / %.3g / %.3g N/m along x, y, z, %.3g N·m/rad, damping ratio %.2g, "
      "reflex %.2g after %.0f ms",
      h.mass, h.stiffness.x(), h.stiffness.y(), h.stiffness.z(), h.rotation_stiffness,
      h.damping_ratio, h.reflex_gain, 1e3 * h.reflex_delay);
}

// Describes a special picture, for example one in which nothing or everything is stable.
std::string Caption(const StabilityMap& map, const MapPicture& picture) {
  const MapAxisText& text = TextOf(picture.axis);
  std::string nothing, found_nothing, everything, impossible;
  const auto list = [&](std::string* to, const MapPoint& p) {
    *to += (to->empty() ? "" : ", ") + Shown(text, p.value);
  };
  for (const MapPoint& p : picture.points) {
    if (!p.simulated) continue;
    if (!p.impossible.empty()) {
      list(&impossible, p);
      continue;
    }
    if (p.predicted.nothing_stable()) list(&nothing, p);
    if (p.found.extent.nothing_stable()) list(&found_nothing, p);
    if (p.predicted.everything_stable() || p.found.extent.everything_stable()) list(&everything, p);
  }
  std::string caption;
  const auto say = [&](const char* what, const std::string& where) {
    if (!where.empty()) caption += std::string(what) + " at " + where + ". ";
  };
  say("Predicted: no hand is stable", nothing);
  say("Simulated: no hand is stable", found_nothing);
  say(Formatted("Everything up to %.0f N/m is stable in prediction or simulation,",
                map.range.stiffest)
          .c_str(),
      everything);
  say("This variant is impossible (see the table)", impossible);
  return caption;
}

std::string Frequency(const Boundary* b) {
  return b && b->frequency > 0 ? Formatted("%.3g", b->frequency) : "–";
}

std::string Stiffness(const StableExtent& extent, const Boundary* b) {
  if (b) return Formatted("%.0f", b->stiffness);
  return extent.nothing_stable()      ? "nothing stable"
         : extent.everything_stable() ? "all stable"
                                      : "–";
}

std::string Joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& s : sentences) text += (text.empty() ? "" : "; ") + EscapeMarkup(s);
  return text;
}

using Cells = std::vector<std::string>;

Cells Row(const StabilityMap& map, const std::string& at, const MapPoint& point,
          const BoundaryPair& pair) {
  const bool holds = pair.departures.empty() && map.departures.empty();
  std::string ratio = pair.predicted && pair.found ? Formatted("%.2f", pair.ratio()) : "–";
  if (holds && !pair.agrees()) ratio = "<b class=\"bad\">" + ratio + "</b>";
  return {at,
          pair.critical ? "stiffest" : "softest",
          Stiffness(point.predicted, pair.predicted),
          Stiffness(point.found.extent, pair.found),
          ratio,
          Frequency(pair.predicted),
          Frequency(pair.found),
          pair.departures.empty() ? "hold" : Joined(pair.departures)};
}

// Describes a point without a boundary.
std::string WithoutBoundary(const MapPoint& point) {
  if (!point.impossible.empty()) return EscapeMarkup(point.impossible);
  return point.predicted.nothing_stable() ? "predicted and simulated: nothing is stable"
                                          : "predicted and simulated: everything is stable";
}

std::string Table(const StabilityMap& map, const MapPicture& picture) {
  std::vector<Cells> rows = {{"at", "boundary", "predicted [N/m]", "simulated [N/m]", "ratio",
                              "predicted [Hz]", "simulated [Hz]", "assumptions"}};
  for (const MapPoint& point : picture.points) {
    if (!point.simulated) continue;
    const std::string at = Shown(TextOf(picture.axis), point.value);
    const auto pairs = PairsOf(point);
    for (const BoundaryPair& pair : pairs) rows.push_back(Row(map, at, point, pair));
    if (pairs.empty()) rows.push_back({at, "–", "–", "–", "–", "–", "–", WithoutBoundary(point)});
  }
  return HtmlTable(rows);
}

std::string Assumptions(const StabilityMap& map) {
  std::string html =
      "<p>The prediction applies to small motions about the start. The prediction does not apply "
      "where something limits the motion. A simulated boundary is compared with it unless one of "
      "these conditions, fixed beforehand, occurs in the simulations near the boundary:</p><ul>";
  html += Formatted("<li>on the stable side, without a tap, for more than %.0f %% of the time:",
                    100 * kLimitedShare);
  for (int k = 0; k < kLimitings; ++k)
    html += std::string(k > 0 ? ", " : " ") + Name(static_cast<Limiting>(k));
  html +=
      " (displacement: more than 20 mm or 0.1 rad from the start, where the loop was "
      "linearised);</li>";
  html +=
      "<li>on the unstable side, noise alone reaches such a limit before the growth can be "
      "measured;</li>";
  html += Formatted(
      "<li>the growth rates scatter so much, relative to their dependence on stiffness, that the "
      "boundary is uncertain by more than %.0f %% (two standard errors), or fewer than three rates "
      "were measured near it.</li></ul>\n",
      100 * kMaxUncertainty);
  if (map.departures.empty())
    return html + "<p>No property of this scenario as a whole invalidates the prediction.</p>\n";
  html += "<p>In this scenario the prediction is not valid, because:</p><ul>";
  for (const std::string& d : map.departures) html += "<li>" + EscapeMarkup(d) + "</li>";
  return html + "</ul>\n";
}

std::string HowItWasMade(const StabilityMap& map) {
  return Formatted(
      "<p>A hand's stiffness is given by its largest component. The other components and the "
      "rotational stiffness scale with it; the damping ratio stays constant. Everything else is as "
      "in the scenario, with a lead of %.1f ms. The searched range is %.0f to %.0f N/m. An object "
      "of another mass keeps its shape; it sags by a different length, and the arms' bases follow "
      "its handles.</p>\n"
      "<p><b>Predicted</b>: the eigenvalues of the loop hand → sensor → virtual world → rendering "
      "→ arms → hand, linearised at the start: both hands, six directions, lever arms, reflex and "
      "vision with their delays, the filters of sensor and lead, and the arms' velocity loops. "
      "<code>predictor check</code> adds 1.5 ticks of delay as a reserve for real devices.</p>\n"
      "<p><b>Simulated</b>: the emulator itself runs twice with the same noise, with hands that "
      "grip and hold, and without stops. In one of the two runs the hands tap the handles. The "
      "difference between the two motions grows or decays over the %.0f s after the tap. The "
      "boundary is found by bisection on that sign, to 4 %%, near the predicted boundary and on a "
      "grid over the whole range. The frequency is the strongest line in the spectrum of the "
      "difference.</p>\n"
      "<p>Prediction and simulation apply to the start of the scenario. Far from there, the "
      "postures of the arms and the cobot differ, and so does the boundary.</p>\n",
      1e3 * map.base.lead, map.range.softest, map.range.stiffest, map.growth_time);
}

// Adds the chapters about the hands.
void AddHands(const StabilityMap& map, ReportPage* page) {
  page->Section("map", "Map");
  for (const MapPicture& picture : map.pictures) {
    Plot plot = MapPlot(map, picture);
    plot.caption = Caption(map, picture);
    page->Figure(plot);
  }
  page->Section("assumptions", "Where the prediction's assumptions hold");
  page->Html(Assumptions(map));
  page->Section("boundaries", "All boundaries");
  for (const MapPicture& picture : map.pictures)
    page->Html(std::string("<h3>") + TextOf(picture.axis).quantity + "</h3>\n" +
               Table(map, picture));
  page->Section("method", "How it was made");
  page->Html(HowItWasMade(map));
}

std::string HandWords(const StabilityMap& map) {
  return "<p>Stiffness of the hands up to which the haptic loop is stable. Below the line a "
         "disturbance decays; above the line it grows.</p>\n"
         "<p>" +
         Verdict(map) + "</p>\n";
}

}  // namespace

std::string MapPage(const StabilityMap& map) {
  const bool hands = map.has_hands();
  std::string words = hands ? HandWords(map) : "";
  words += Formatted("<p>Object of %.3g kg; lead %.1f ms of the arms' lag of %.1f ms; hand ",
                     map.base.object_mass, 1e3 * map.base.lead, 1e3 * map.base.lag) +
           HandInWords(map) + ".</p>\n";
  ReportPage page("Stability map: " + map.base.scenario.name, words);
  if (hands) AddHands(map, &page);
  AddWalls(map, &page);
  return page.Finish();
}

std::string MapText(const StabilityMap& map) {
  if (!map.has_hands()) return WallText(map);
  std::string text;
  AppendLine(&text, "Stability map    stiffest stable hand [N/m]: predicted, simulated");
  for (const MapPicture& picture : map.pictures) {
    const MapAxisText& axis = TextOf(picture.axis);
    AppendLine(&text, "  %s", axis.quantity);
    for (const MapPoint& p : picture.points) {
      if (!p.simulated) continue;
      if (!p.impossible.empty()) {
        AppendLine(&text, "    %-10s impossible variant", Shown(axis, p.value).c_str());
        continue;
      }
      AppendLine(&text, "    %-10s %14s %14s", Shown(axis, p.value).c_str(),
                 Stiffness(p.predicted, p.predicted.critical()).c_str(),
                 Stiffness(p.found.extent, p.found.extent.critical()).c_str());
    }
  }
  return text + Verdict(map) + "\n" + WallText(map);
}

}  // namespace predictor
