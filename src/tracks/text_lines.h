// Splits text files into lines, and reads the numbers in their cells.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace predictor::tracks {

// Returns one line after another, without the end of the line (LF or CR LF) and without a byte
// order mark.
class TextLines {
 public:
  explicit TextLines(std::string_view text);
  // Returns false at the end of the text.
  bool Next(std::string_view* line);
  int number() const { return number_; }  // number of the last line, from 1

 private:
  std::string_view rest_;
  int number_ = 0;
};

// Returns NaN for an empty cell and for "nan" in any spelling, and no value if the text is not a
// number.
std::optional<double> NumberIn(std::string_view cell);

// Returns "file:line", which messages use as the place.
std::string LineOf(const std::string& file, int line);

}  // namespace predictor::tracks
