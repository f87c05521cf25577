// The page and the text of a stability map.
#include "report/page.h"

#include <cmath>
#include <string>

#include "analysis/stability_map/stability_map.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor {
namespace {

std::string Shown(const MapAxisText& text, double value) {
  return Formatted("%.3g %s", text.per_si * value, text.unit);
}

// One or two sentences about the agreement.
std::string Verdict(const StabilityMap& map) {
  const MapAgreement a = AgreementOf(map);
  std::string text;
  if (a.held > 0) {
    text = Formatted(
        "Where the prediction's assumptions hold, %d of %d simulated boundaries lie within "
        "20 %% of the predicted ones",
        a.held_agree, a.held);
    text += Formatted(" (farthest: %.2f times the predicted stiffness). ", a.worst_ratio);
  } else {
    text = "No simulated boundary can be held against the prediction. ";
  }
  if (a.one_sided > 0)
    text += Formatted(
        "In %d cases one of the two finds a boundary that the other does not have within "
        "the range searched. ",
        a.one_sided);
  if (a.other > 0)
    text += Formatted(
        "In %d more the assumptions do not hold; %d of those lie within 20 %% all the "
        "same. ",
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

// Text about a picture, for example if nothing or everything is stable.
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
  say(Formatted("Everything up to %.0f N/m is stable, by prediction or simulation,",
                map.range.stiffest)
          .c_str(),
      everything);
  say("There is no such world (see the table)", impossible);
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

// Text for a point without a boundary.
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
      "<p>The prediction is of small "
      "motion about the start. It says nothing where something limits the motion. A boundary is "
      "held "
      "against it unless one of these, fixed beforehand, is seen in the simulations beside "
      "it:</p><ul>";
  html += Formatted("<li>on the stable side, without a tap, in more than %.0f %% of the time:",
                    100 * kLimitedShare);
  for (int k = 0; k < kLimitings; ++k)
    html += std::string(k > 0 ? ", " : " ") + Name(static_cast<Limiting>(k));
  html +=
      " (displacement: more than 20 mm or 0.1 rad from the start, where the loop was "
      "linearised);</li>";
  html +=
      "<li>on the unstable side, noise alone reaches such a limit before growth can be "
      "measured;</li>";
  html += Formatted(
      "<li>the growth rates scatter so much against their dependence on stiffness that the "
      "boundary is uncertain by more than %.0f %% (two standard errors), or fewer than three of "
      "them were measured beside it.</li></ul>\n",
      100 * kMostUncertain);
  if (map.departures.empty())
    return html + "<p>Nothing in this scenario as a whole speaks against the prediction.</p>\n";
  html += "<p>In this scenario it holds nowhere, for:</p><ul>";
  for (const std::string& d : map.departures) html += "<li>" + EscapeMarkup(d) + "</li>";
  return html + "</ul>\n";
}

std::string HowItWasMade(const StabilityMap& map) {
  return Formatted(
      "<p>A hand's stiffness is told by its largest component; the other "
      "components and the stiffness of rotation go with it, the damping ratio stays. All else is "
      "as "
      "in the scenario, with a lead of %.1f ms, and searched from %.0f to %.0f N/m. An object of "
      "another mass keeps its shape; it sags by another length, and the arms' bases follow its "
      "handles.</p>\n<p><b>Predicted</b>: the eigenvalues of the loop hand → sensor → virtual "
      "world → "
      "rendering → arms → hand, linearised at the start: both hands, six directions, lever arms, "
      "reflex and sight with their delays, the sensor's and the lead's filters, the arms' velocity "
      "loops. The oscillation that <code>predictor check</code> warns of is found with 1.5 ticks "
      "of "
      "delay more, as a reserve for real devices.</p>\n<p><b>Simulated</b>: the emulator itself, "
      "twice with the same noise, hands that grip and hold, no stops; in one of the two runs the "
      "hands tap the handles. The difference of the two motions over the %.0f s after the tap "
      "grows "
      "or decays; the boundary is found by bisection on that sign, to 4 %%, beside the predicted "
      "boundary and on a grid over the whole range. The frequency is the strongest line in the "
      "difference's spectrum.</p>\n<p>Both are for where the scenario starts. Far from there the "
      "arms' and the cobot's postures are others, and so is the boundary.</p>\n",
      1e3 * map.base.lead, map.range.softest, map.range.stiffest, map.growth_time);
}

}  // namespace

std::string MapPage(const StabilityMap& map) {
  std::string words =
      "<p>How stiff a hand may hold the handles before the haptic loop oscillates by itself. Below "
      "the line a disturbance decays, above it grows.</p>\n<p>" +
      Verdict(map) + "</p>\n";
  words += Formatted("<p>Object of %.3g kg; lead %.1f ms of the arms' lag of %.1f ms; hand ",
                     map.base.object_mass, 1e3 * map.base.lead, 1e3 * map.base.lag) +
           HandInWords(map) + ".</p>\n";
  ReportPage page("Stability map: " + map.base.scenario.name, words);
  page.Section("map", "Map");
  for (const MapPicture& picture : map.pictures) {
    Plot plot = MapPlot(map, picture);
    plot.caption = Caption(map, picture);
    page.Figure(plot);
  }
  page.Section("assumptions", "Where the prediction's assumptions hold");
  page.Html(Assumptions(map));
  page.Section("boundaries", "All boundaries");
  for (const MapPicture& picture : map.pictures)
    page.Html(std::string("<h3>") + TextOf(picture.axis).quantity + "</h3>\n" +
              Table(map, picture));
  page.Section("method", "How it was made");
  page.Html(HowItWasMade(map));
  return page.Finish();
}

std::string MapText(const StabilityMap& map) {
  std::string text;
  AppendLine(&text, "Stability map    stiffest stable hand [N/m]: predicted, simulated");
  for (const MapPicture& picture : map.pictures) {
    const MapAxisText& axis = TextOf(picture.axis);
    AppendLine(&text, "  %s", axis.quantity);
    for (const MapPoint& p : picture.points) {
      if (!p.simulated) continue;
      if (!p.impossible.empty()) {
        AppendLine(&text, "    %-10s no such world", Shown(axis, p.value).c_str());
        continue;
      }
      AppendLine(&text, "    %-10s %14s %14s", Shown(axis, p.value).c_str(),
                 Stiffness(p.predicted, p.predicted.critical()).c_str(),
                 Stiffness(p.found.extent, p.found.extent.critical()).c_str());
    }
  }
  text += Verdict(map) + "\n";
  return text;
}

}  // namespace predictor
