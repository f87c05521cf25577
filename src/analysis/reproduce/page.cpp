// Writes the page of a reproduction, its files, and its numbers as text.
#include "report/page.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/reproduce/runs.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "core/json_schema.h"
#include "core/text.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

// Returns "" if the value is not defined.
std::string Cell(double x) { return std::isfinite(x) ? FormatNumber(x) : ""; }

std::string Comparable() {
  return "<p><b>Comparable:</b> the equations, the gains (Kp 2, Ko 0.4, K′p 1, K′o 0.9), the "
         "boxes' size and mass, the controller's stiffness, the thresholds and distances of "
         "safety.</p>\n"
         "<p><b>Not comparable:</b> the paper's arms are real and our arms are simulated (a "
         "second-order velocity loop with a delay; all links are rigid). A simulated operator "
         "replaces seventeen people: its motion and the positions of the bases are our "
         "assumptions. The figures show the performance of the software with an arm that behaves "
         "like its model. The paper's results from people (Table 1) cannot be reproduced "
         "here.</p>\n";
}

std::string CommandList(const ReproducedExperiment& experiment) {
  std::vector<std::string> commands;
  for (const ReproducedNumber& n : experiment.numbers)
    if (std::ranges::find(commands, n.command) == commands.end()) commands.push_back(n.command);
  std::string text = "predictor reproduce --only " + experiment.name + "\n";
  for (const std::string& c : commands)
    if (!c.starts_with("predictor reproduce")) text += c + "\n";
  return text;
}

// Converts the name of a scenario to a label, for example "box_9kg" to "9 kg: ". Returns "" for
// experiments whose rows are unambiguous.
std::string ShortName(const std::string& experiment) {
  if (experiment == "box_9kg") return "9 kg: ";
  if (experiment == "box_18kg") return "18 kg: ";
  return "";
}

// Shows, for all experiments without people, the results that the paper also prints.
std::string Overview(const Reproduction& reproduction) {
  std::vector<ReproducedNumber> numbers;
  for (const ReproducedExperiment& e : reproduction.experiments)
    for (ReproducedNumber n : e.numbers) {
      if (!n.paper || n.variant || e.name == "questionnaire") continue;
      n.quantity = ShortName(e.name) + n.quantity;
      numbers.push_back(std::move(n));
    }
  return numbers.empty() ? "" : NumbersTable(numbers);
}

}  // namespace

std::string ReproductionPage(const Reproduction& reproduction) {
  ReportPage page(
      "The paper's experiments, repeated",
      "<p>PREDICTOR " + EscapeMarkup(reproduction.program_version) + " · virtual time" +
          (reproduction.engine.empty() ? "" : "; engine: " + EscapeMarkup(reproduction.engine)) +
          "; computing times measured on: " + EscapeMarkup(reproduction.machine) +
          "</p>\n<p>The paper: PREDICTOR: A Physical emulatoR enabling safEty anD ergonomICs "
          "evaluation and Training of physical human-rObot collaboRation, Frontiers in "
          "Neurorobotics 17 (2023).</p>\n");
  page.Section("overview", "Results");
  const std::string overview = Overview(reproduction);
  if (!overview.empty())
    page.Html(
        "<p>All results of section 4 that can be measured without people: mean ± standard "
        "deviation (maximum). Ratio: our mean divided by the paper's.</p>\n" +
        overview);
  page.Html(Comparable());
  for (const ReproducedExperiment& e : reproduction.experiments) {
    page.Section(e.name, e.title);
    for (const ReproducedBlock& block : e.blocks) {
      page.Html(block.html);
      if (block.plot) page.Figure(*block.plot);
    }
    page.Html(
        "<h3>To repeat this experiment</h3>\n"
        "<pre style=\"white-space:pre-wrap\">" +
        EscapeMarkup(CommandList(e)) + "</pre>\n");
  }
  page.Section("data", "Data");
  page.Paragraph(
      "The curves show the minimum and maximum of each interval of 50 ms. Within eight seconds "
      "around stops and worst errors, the curves show every tick. The files numbers.json and "
      "numbers.csv next to this page contain all numbers with more digits. The folder figures/ "
      "contains the images as PNG. Runs in virtual time are reproducible bit for bit with the same "
      "build, but computing times are not.");
  return page.Finish();
}

std::string ReproductionJson(const Reproduction& reproduction) {
  Json json = {{"program_version", reproduction.program_version},
               {"machine", reproduction.machine},
               {"engine", reproduction.engine},
               {"experiments", Json::array()}};
  for (const ReproducedExperiment& e : reproduction.experiments) {
    Json numbers = Json::array();
    for (const ReproducedNumber& n : e.numbers) {
      Json paper = n.paper ? Json{{"mean", n.paper->mean}, {"deviation", n.paper->deviation}}
                           : Json(nullptr);
      numbers.push_back({{"place", n.place},
                         {"quantity", n.quantity},
                         {"unit", n.unit},
                         {"condition", n.condition},
                         {"paper", std::move(paper)},
                         {"mean", NumberOrNull(n.mean)},
                         {"deviation", NumberOrNull(n.deviation)},
                         {"largest", NumberOrNull(n.largest)},
                         {"ratio", n.ratio() ? Json(*n.ratio()) : Json(nullptr)},
                         {"command", n.command}});
    }
    json["experiments"].push_back({{"name", e.name},
                                   {"title", e.title},
                                   {"wall_seconds", e.wall},
                                   {"numbers", std::move(numbers)}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ReproductionCsv(const Reproduction& reproduction) {
  std::string csv =
      "experiment,place,quantity,unit,condition,paper_mean,paper_deviation,mean,deviation,largest,"
      "ratio,command\n";
  for (const ReproducedExperiment& e : reproduction.experiments)
    for (const ReproducedNumber& n : e.numbers) {
      const std::vector<std::string> cells = {CsvCell(e.name),
                                              CsvCell(n.place),
                                              CsvCell(n.quantity),
                                              CsvCell(n.unit),
                                              CsvCell(n.condition),
                                              n.paper ? FormatNumber(n.paper->mean) : "",
                                              n.paper ? FormatNumber(n.paper->deviation) : "",
                                              Cell(n.mean),
                                              Cell(n.deviation),
                                              Cell(n.largest),
                                              n.ratio() ? FormatNumber(*n.ratio()) : "",
                                              CsvCell(n.command)};
      csv += Join(cells, ",") + "\n";
    }
  return csv;
}

std::string ReproductionText(const Reproduction& reproduction) {
  std::string text;
  for (const ReproducedExperiment& e : reproduction.experiments) {
    AppendLine(&text, "%s (%.1f s)", e.title.c_str(), e.wall);
    for (const ReproducedNumber& n : e.numbers) {
      if (!n.paper || e.name == "questionnaire") continue;
      const std::string paper = Printed(*n.paper);
      AppendLine(&text, "  %-44s %-26s paper %-14s ours %-16s %s", n.quantity.c_str(),
                 n.condition.c_str(), paper.c_str(), PlusMinus(n.mean, n.deviation).c_str(),
                 n.unit.c_str());
    }
  }
  return text;
}

void WriteReproduction(const Reproduction& reproduction, const std::filesystem::path& folder) {
  const std::filesystem::path figures = folder / "figures";
  std::error_code error;
  std::filesystem::create_directories(figures, error);
  WriteWholeFile(folder / "index.html", ReproductionPage(reproduction));
  WriteWholeFile(folder / "numbers.json", ReproductionJson(reproduction));
  WriteWholeFile(folder / "numbers.csv", ReproductionCsv(reproduction));
  for (const ReproducedExperiment& e : reproduction.experiments)
    for (const ReproducedImage& image : e.images)
      WriteWholeFile(figures / (image.id + ".png"), image.bytes);
}

}  // namespace predictor
