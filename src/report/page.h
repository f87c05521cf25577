// Writes one self-contained HTML page with text, tables and plots. The page needs no network, has a
// light and a dark theme, and can be printed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "report/plot.h"

namespace predictor {

// Rounds each value to a whole number of steps. A byte 0 represents a value that is not finite.
// For a finite value, the byte 1 is followed by the zigzag-coded difference from the previous
// value, in groups of seven bits with the lowest group first. The eighth bit of a byte means that
// more bytes follow. Slowly varying values take one byte each.
std::string EncodeSteps(const std::vector<double>& values, double step);

std::string Base64(const std::string& bytes);

// The columns of a page. Each distinct column is stored once.
class PageData {
 public:
  // Returns the column's number. `step` is the rounding step of the values, or 0 for 1/50000 of
  // their range.
  int Add(const Samples& values, double step);
  // Returns the columns as HTML elements of the page.
  std::string Html() const { return html_; }

 private:
  std::map<const void*, int> numbers_;
  std::vector<Samples> kept_;  // keeps the columns alive, so that no new column gets the address of
                               // an old one
  std::string html_;
};

// A page that contains its plots as data. The script of the page draws the plots on the screen and
// on paper.
class ReportPage {
 public:
  // `words` is the HTML that appears below the title.
  explicit ReportPage(std::string title, std::string words = "");

  // Starts a chapter. `id` is unique within the page.
  void Section(const std::string& id, const std::string& title);
  // Adds raw HTML. Escape any external text first (EscapeMarkup).
  void Html(const std::string& html);
  void Paragraph(const std::string& text);  // plain text; it is escaped here
  void Figure(const Plot& plot);
  // Adds the text of a file, which is collapsed until the user opens it.
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

// Returns a table whose first row is the header and whose first column names the rows. Cells are
// HTML.
std::string HtmlTable(const std::vector<std::vector<std::string>>& rows);

}  // namespace predictor
