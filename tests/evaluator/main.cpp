// The test program also serves as the evaluator's process, as `predictor` does.
#include <gtest/gtest.h>

#include <cstring>

#include "evaluator/evaluator_process.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], predictor::evaluator::kEvaluatorSubcommand) == 0)
    return predictor::evaluator::EvaluatorMain();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
