// Encodes numbers for a page: rounded, as differences, in base64.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "report/plot.h"

namespace predictor {

// Each value is rounded to a whole number of steps. A byte 0 represents a value that is not finite.
// Otherwise the byte 1 is followed by the zigzag-coded difference from the previous value, in
// groups of seven bits, lowest group first; the eighth bit means that more bytes follow. Slowly
// varying values take one byte each.
std::string EncodeSteps(const std::vector<double>& values, double step);

std::string Base64(const std::string& bytes);

// The columns of a page. Each distinct column is stored once.
class PageData {
 public:
  // Returns the column's number. step: rounding step of the values; 0: 1/50000 of their range.
  int Add(const Samples& values, double step);
  // The columns as HTML elements of the page.
  std::string Html() const { return html_; }

 private:
  std::map<const void*, int> numbers_;
  std::vector<Samples> kept_;  // keeps the columns alive, so that no new column gets the address of
                               // an old one
  std::string html_;
};

}  // namespace predictor
