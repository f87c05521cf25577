// Writes web/src/quantities.ts to standard output.
#include <cstdio>

#include "viewer/frame.h"

int main() { return std::fputs(predictor::viewer::PageQuantities().c_str(), stdout) < 0 ? 1 : 0; }
