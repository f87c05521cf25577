// Writes web/src/quantities.ts to standard output, or web/src/person_state.ts with the argument
// `person`.
#include <cstdio>
#include <string_view>

#include "viewer/frame.h"

int main(int argc, char** argv) {
  const bool person = argc == 2 && std::string_view(argv[1]) == "person";
  const std::string text =
      person ? predictor::viewer::PagePerson() : predictor::viewer::PageQuantities();
  return std::fputs(text.c_str(), stdout) < 0 ? 1 : 0;
}
