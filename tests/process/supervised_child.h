// A process for the tests of supervision. The first line of its input selects its behaviour.
#pragma once

namespace predictor {

inline constexpr const char* kTestSubcommand = "test-process";
int SupervisedChildMain();

}  // namespace predictor
