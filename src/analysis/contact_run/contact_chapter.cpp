// Writes the report's chapter about contact.
#include <array>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "analysis/contact_run/contact_run.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor {
namespace {

using Cells = std::vector<std::string>;

constexpr double kKilo = 1000;
constexpr double kStiff = 1e7;  // a contact with this stiffness is plotted in MN/m [N/m]

// Returns a stiffness in kN/m.
std::string Kilo(double stiffness) { return Formatted("%.3g", stiffness / kKilo); }

std::string Requested(const ContactReport& r) {
  const Surface::Kind kind = r.surfaces[0].kind;
  if (kind == Surface::Kind::kTable || kind == Surface::Kind::kFloor) return "not given";
  if (!r.yields) return "rigid";
  return Kilo(r.wall.stiffness) + " kN/m, " + Formatted("%.3g N·s/m", r.wall.damping);
}

std::string LargestStable(const ContactReport& r) {
  if (!r.limit.reached) return "> " + Kilo(kStiffestWall);
  return (r.limit.stiffness > 0 ? Kilo(r.limit.stiffness) : "none") +
         Formatted(" (%.1f Hz)", r.limit.frequency);
}

std::string PredictionTable(const ContactRun& run) {
  std::vector<Cells> rows = {{"contact with", "requested", "contact", "stable up to [kN/m]",
                              "at rest [kN/m]", "at 5 Hz [kN/m]", "at 5 Hz [N·s/m]"}};
  const auto pair = [](const std::string& rendered, const std::string& requested) {
    return rendered + " of " + requested;
  };
  const auto damping = [](const std::complex<double>& impedance) {
    return Formatted("%.3g", DampingOf(impedance, kFeltFrequency));
  };
  const auto judged = [](bool stable) {
    return stable ? "stable" : "<b class=\"bad\">unstable</b>";
  };
  const auto add_mass = [&](const ContactReport& r, const char* how,
                            const std::optional<AddedMass>& added) {
    if (!added) return;
    rows.push_back({EscapeMarkup(r.what) + ", " + how, Formatted("%.3g kg more", added->mass),
                    judged(added->stable), "–", "–",
                    pair(Kilo(added->moving.rendered.real()), Kilo(added->moving.requested.real())),
                    pair(damping(added->moving.rendered), damping(added->moving.requested))});
  };
  for (const ContactReport& r : run.predictions) {
    rows.push_back({EscapeMarkup(r.what) + (r.is_movable() ? " that cannot move"
                                            : r.at_start   ? " as at the start"
                                                           : ""),
                    Requested(r), judged(r.stable), LargestStable(r),
                    pair(Kilo(r.at_rest.rendered.real()), Kilo(r.at_rest.requested.real())),
                    pair(Kilo(r.moving.rendered.real()), Kilo(r.moving.requested.real())),
                    pair(damping(r.moving.rendered), damping(r.moving.requested))});
    add_mass(r, "pushed", r.pushed);
    add_mass(r, "held", r.held);
  }
  return HtmlTable(rows);
}

std::string FactsTable(const ContactRun& run) {
  const bool simulated = run.scenario.operator_.type == "virtual";
  std::vector<Cells> rows = {{"contact with", "time in contact [s]", "deepest penetration [mm]",
                              "contact force [N]", "pressed with [N]"},
                             {"origin", "computed", "computed", "modelled",
                              simulated ? "measured (simulated sensors)" : "measured"}};
  for (const ContactFacts& f : run.facts) {
    const bool touched = f.time > 0;
    if (!touched && f.surface.kind == Surface::Kind::kFloor) continue;
    const bool yields = f.surface.kind == Surface::Kind::kFixture &&
                        run.scenario.environment.fixtures[f.surface.number].stiffness.has_value();
    const auto value = [&](double x) { return touched ? Formatted("%.3g", x) : "–"; };
    rows.push_back({EscapeMarkup(PhraseOf({f.surface}, &run.scenario)), Formatted("%.2f", f.time),
                    value(kKilo * f.depth), yields ? value(f.force) : "not recorded",
                    value(f.pressing)});
  }
  return HtmlTable(rows);
}

Plot ImpedancePlot(const ContactRun& run, std::size_t k) {
  const ContactReport& r = run.predictions[k];
  const bool is_stiff = std::abs(r.at_rest.requested) > kStiff;
  const double unit = is_stiff ? kKilo * kKilo : kKilo;
  std::array<std::vector<double>, 2> magnitude;
  std::vector<double> frequency;
  for (const FeltAt& at : r.spectrum) {
    frequency.push_back(at.frequency);
    magnitude[0].push_back(std::abs(at.felt.requested) / unit);
    magnitude[1].push_back(std::abs(at.felt.rendered) / unit);
  }
  Plot plot;
  plot.id = "impedance-" + std::to_string(k + 1);
  plot.title = "Requested and rendered impedance: " + r.what;
  plot.caption =
      "Ratio of force to displacement of the handles, predicted for contact at one point: the "
      "requested ratio, which the virtual world has, and the ratio that the arms render.";
  plot.x = {.label = "Frequency", .unit = "Hz", .log = true};
  plot.x.low = frequency.front();
  plot.x.high = frequency.back();
  PlotPanel panel;
  panel.y = {.label = "Magnitude", .unit = is_stiff ? "MN/m" : "kN/m", .log = true};
  panel.series = {{.label = "requested", .color = 0, .style = LineStyle::kDashed},
                  {.label = "rendered", .color = 1}};
  for (std::size_t i = 0; i < magnitude.size(); ++i)
    panel.series[i].SetPoints(frequency, std::move(magnitude[i]));
  plot.panels.push_back(std::move(panel));
  return plot;
}

constexpr const char* kPredictionWords =
    "<h3>What the arms can render (modelled)</h3>\n<p>These values are predicted with the "
    "linearised loop at the start of the run, for small motions that stay in contact at one point. "
    "Against a wall that is stiffer than <i>stable up to</i>, the loop oscillates at the frequency "
    "in brackets. A movable object is judged as one that cannot move and, in the rows "
    "<i>pushed</i> and <i>held</i>, as a mass that moves with the carried object. The first of two "
    "numbers is what the arms render, the second what the virtual "
    "world requests. In motion, the lag of the arms turns stiffness into damping, so a wall feels "
    "dull, and a part of the inertia into negative damping, which feeds energy into the hands. The "
    "contact with a body without a given stiffness has a stiffness and an inertia in the "
    "simulation, which the plot contains. For it, <i>stable up to</i> applies to a spring without "
    "damping in its place. The "
    "prediction assumes that the arms do not bend, so real arms render less at rest.</p>\n";

constexpr const char* kFactsWords =
    "<h3>Contact in this run</h3>\n<p>Penetration and forces are the largest ones of the run. Time "
    "and penetration are computed from the recorded motions of the bodies. The recording contains "
    "no contact forces. For a fixture that yields, the force at all points of contact together is "
    "modelled: it follows from the fixture's stiffness and damping, the penetration and its speed. "
    "The last column is the force with which the hands together pressed on the touched body, by "
    "the force sensors.</p>\n";

void AddLinkContacts(const Scenario& s, ReportPage* page) {
  const std::vector<std::string> keys = LinkContacts(s);
  if (keys.empty()) return;
  page->Paragraph("Contact of the cobot's links is neither described nor predicted here (" +
                  Join(keys) +
                  "). The prediction knows only forces on the carried object, and the recording "
                  "contains no contact forces.");
}

}  // namespace

void AddContactChapter(const ContactRun& run, ReportPage* page) {
  if (!run.has_chapter()) return;
  page->Section("contact", "Contact: what the device cannot render");
  if (!run.problem.empty()) page->Paragraph(run.problem);
  if (!run.facts.empty()) page->Html(kFactsWords + FactsTable(run));
  AddLinkContacts(run.scenario, page);
  if (run.scenario.mode == Mode::kDirect)
    return page->Paragraph("In `mode: direct`, no arms render the contact.");
  if (run.predictions.empty()) return;
  page->Html(kPredictionWords);
  page->Html(Formatted("<p>Lead: %.1f ms.</p>\n", 1e3 * run.lead) + PredictionTable(run));
  for (std::size_t k = 0; k < run.predictions.size(); ++k) page->Figure(ImpedancePlot(run, k));
}

}  // namespace predictor
