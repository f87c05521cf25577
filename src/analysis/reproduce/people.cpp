// Reproduces section 4.2: the answers of the participants (Table 1, Fig. 11), and responsiveness.
#include <cmath>

#include "analysis/reproduce/paper.h"
#include "analysis/reproduce/runs.h"
#include "evaluation/questionnaire_report.h"
#include "evaluation/questionnaire_table.h"
#include "report/page.h"
#include "report/run_plots.h"
#include "report/survey_page.h"

namespace predictor {
namespace {

std::string CountsInWords(const ScoreCounts& counts) {
  std::string text;
  for (std::size_t s = 0; s < kScores; ++s) {
    if (counts[s] == 0) continue;
    const int score = kLowestScore + static_cast<int>(s);
    text += (text.empty() ? "" : ", ") + std::to_string(counts[s]) + " × " +
            (score < 0 ? "−" : "") + std::to_string(std::abs(score));
  }
  return text;
}

struct Rows {
  std::vector<std::vector<std::string>> table = {{"Statement", "Paper",
                                                  "Number of the 17 answers with this value",
                                                  "Mean ± sd of these", "Median"}};
  std::vector<LikertSeries> plots = {{"First", {}}, {"Second", {}}};
  std::vector<ReproducedNumber> numbers;
};

void AddStatement(std::size_t i, Rows* rows) {
  const PaperRow& row = PaperTable()[i];
  const std::vector<ScoreCounts> all = MatchingCounts(row.figures, kPaperPeople, row.lowest);
  const std::string name = Statements()[i].name;
  const PrintedValue printed{row.figures.mean / 100.0, row.figures.deviation / 100.0, 2};
  for (std::size_t k = 0; k < all.size(); ++k) {
    const StatementSummary s = SummariseCounts(all[k]);
    rows->table.push_back({k == 0 ? name + " (" + Statements()[i].aspect + ")" : name + ", or",
                           k == 0 ? Printed(printed) : "", CountsInWords(all[k]),
                           PlusMinus(s.mean, s.deviation), Round(s.median)});
    ReproducedNumber n;
    n.quantity = name;
    n.unit = "score";
    n.condition = "solution " + std::to_string(k + 1) + " of " + std::to_string(all.size());
    n.paper = printed;
    n.mean = s.mean;
    n.deviation = s.deviation;
    n.command = "predictor reproduce --only questionnaire";
    Add(std::move(n), "Table 1, Fig. 11", &rows->numbers);
  }
  for (std::size_t k = 0; k < rows->plots.size(); ++k)
    if (!all.empty()) rows->plots[k].counts[i] = all[std::min(k, all.size() - 1)];
}

}  // namespace

ReproducedExperiment ReproduceQuestionnaire(ReproduceRuns* runs) {
  ReproducedExperiment e;
  Rows rows;
  for (std::size_t i = 0; i < kStatements; ++i) AddStatement(i, &rows);
  runs->ReportProgress(1);
  e.numbers = rows.numbers;
  e.AddParagraph(
      "No participants were asked for this reproduction. The table lists every set of 17 integer "
      "answers from −2 to 2 that matches the mean and the sample standard deviation in Table 1. "
      "For S2, S3, S4 and S8, the set also matches the lowest answer that the text states. Fig. 11 "
      "is redrawn from these sets, not from the printed figure. To ask people yourself, use "
      "predictor survey ask.");
  e.Add(HtmlTable(rows.table));
  e.Add(LikertPlot(rows.plots), "fig11", "Distributions behind Table 1 (Fig. 11)",
        "The plot shows a cross for each answer. Where Table 1 allows only one distribution, both "
        "solutions are the same.");
  return e;
}

ReproducedExperiment ReproduceResponsiveness(ReproduceRuns* runs) {
  ReproducedExperiment e;
  const ReproducedRun run = runs->Run({"box_9kg", {}, "our defaults"});
  const auto add = [&](const char* quantity, Stage stage) {
    const Statistics& us = run.timing[static_cast<std::size_t>(stage)];
    ReproducedNumber n = NumberOf(run, quantity, us, 1e-3, "ms");
    n.paper = kPaperDelay;
    Add(n, "section 4.2.2", &e.numbers);
    // Other programs on the computer affect the mean and the standard deviation, but hardly affect
    // the median.
    n.quantity += ", median";
    n.mean = 1e-3 * run.data.summary
                        .Get<Quantiles>(std::string("timing_us.") +
                                        kStageNames[static_cast<std::size_t>(stage)])
                        .p50;
    n.deviation = n.largest = std::nan("");
    Add(std::move(n), "section 4.2.2", &e.numbers);
  };
  add("rendering: Jacobians, limits, QP", Stage::kRender);
  add("the whole tick", Stage::kTick);
  e.Add(NumbersTable(e.numbers));
  e.AddParagraph(
      "The paper's 10 ± 1 ms is the delay between haptic and visual rendering. It is mainly the "
      "computing time of the QP, in Python, on an unspecified computer. Our values are wall-clock "
      "computing times of a run in virtual time on the machine named at the top, which may also "
      "have done other work: the median characterises the software, the maximum the machine. The "
      "delay to the image in a browser or a headset is not included; predictor report shows it for "
      "a recorded run.");
  e.Add(TickHistogram({RunCurves(run.data)}), "responsiveness-ticks", "Computing time of a tick",
        "");
  return e;
}

}  // namespace predictor
