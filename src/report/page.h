// One self-contained HTML page with text, tables and plots. It needs no network, has light and dark
// themes, and can be printed.
#pragma once

#include <string>
#include <vector>

#include "report/encode.h"
#include "report/plot.h"

namespace predictor {

// The page contains its plots as data; its script draws them on the screen and on paper.
class ReportPage {
 public:
  // `words`: HTML shown under the title.
  explicit ReportPage(std::string title, std::string words = "");

  // Starts a chapter. `id` is unique within the page.
  void Section(const std::string& id, const std::string& title);
  // Adds raw HTML: escape any external text (EscapeMarkup).
  void Html(const std::string& html);
  void Paragraph(const std::string& text);  // plain text; it is escaped here
  void Figure(const Plot& plot);
  // Adds the text of a file, collapsed until the user opens it.
  void Folded(const std::string& title, const std::string& text);

  std::string Finish();
  const std::vector<Plot>& plots() const { return plots_; }

 private:
  void Close();
  std::string title_, words_, navigation_, body_;
  std::vector<Plot> plots_;
  PageData data_;
  std::string description_;  // of the plots, as JSON
  bool open_ = false;
};

// A table whose first row is the header and whose first column names the rows. Cells are HTML.
std::string HtmlTable(const std::vector<std::vector<std::string>>& rows);

}  // namespace predictor
