// Numbers in a page: rounded, as differences, in base64.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "report/plot.h"

namespace predictor {

// Each value is a whole number of steps; a byte 0 stands for what is not finite, else 1 and the
// zigzag-coded difference from the value before, seven bits a byte, the lowest first, the eighth
// bit says that more follow. What varies slowly takes a byte a value.
std::string EncodeSteps(const std::vector<double>& values, double step);

std::string Base64(const std::string& bytes);

// The columns of a page, each once.
class PageData {
 public:
  // The column's number. step: to which the values are rounded; 0: a 50000th of their range.
  int Add(const Samples& values, double step);
  // As elements of the page.
  std::string Html() const { return html_; }

 private:
  std::map<const void*, int> numbers_;
  std::vector<Samples> kept_;  // so that no other column comes to lie where one was
  std::string html_;
};

}  // namespace predictor
