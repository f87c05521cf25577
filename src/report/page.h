// One self-contained HTML page with text, tables and plots: no network, dark and light, for paper.
#pragma once

#include <string>
#include <vector>

#include "report/encode.h"
#include "report/plot.h"

namespace predictor {

// Each plot is drawn twice: as SVG within the page, which is what is printed and what is seen
// without scripts, and by the page's script, where one can zoom and read values.
class ReportPage {
 public:
  // `words`: under the title, HTML.
  explicit ReportPage(std::string title, std::string words = "");

  // A chapter; `id` within the page.
  void Section(const std::string& id, const std::string& title);
  // HTML as it is: escape what comes from elsewhere (svg.h).
  void Html(const std::string& html);
  void Paragraph(const std::string& text);  // text, escaped
  void Figure(const Plot& plot);
  // Text of a file, closed until asked for.
  void Folded(const std::string& title, const std::string& text);

  std::string Finish();
  const std::vector<Plot>& plots() const { return plots_; }

 private:
  void Close();
  std::string title_, words_, navigation_, body_;
  std::vector<Plot> plots_;
  PageData data_;
  std::string description_;  // of the plots, JSON
  bool open_ = false;
};

// A table: the first row is its head, the first column names the rows. Cells are HTML.
std::string HtmlTable(const std::vector<std::vector<std::string>>& rows);

// Writes each plot as DIR/ID.svg. Throws InputError if a file cannot be written.
void WriteSvgs(const std::vector<Plot>& plots, const std::string& folder);

}  // namespace predictor
