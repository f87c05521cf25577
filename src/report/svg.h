// A plot as SVG.
#pragma once

#include <string>

#include "report/plot.h"

namespace predictor {

enum class SvgColors {
  kFile,  // of its own, on white: a file for itself, for print
  kPage,  // by the page's style (var(--c0), var(--ink), ...): dark and light
};

struct SvgOptions {
  double width = 900;         // [px]
  double panel_height = 170;  // of a panel of height 1 [px]
  SvgColors colors = SvgColors::kFile;
};

// Lines are drawn by what can be seen of them: the lowest and highest point of each half pixel.
std::string ToSvg(const Plot& plot, const SvgOptions& options = {});

// "#0072b2": colour of a series on white.
const char* PlotColor(int index);

}  // namespace predictor
