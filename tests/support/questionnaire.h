// Answers to the questionnaire.
#pragma once

#include <string>
#include <vector>

#include "evaluation/questionnaire_files.h"
#include "evaluation/questionnaire_report.h"
#include "evaluation/questionnaire_table.h"

namespace predictor {

inline StoredAnswer Stored(const std::string& pseudonym, Condition condition, int score) {
  StoredAnswer stored;
  stored.answer.pseudonym = pseudonym;
  stored.answer.condition = condition;
  stored.answer.scores.fill(score);
  return stored;
}

// Returns the answers of the paper's own study, from one of the distributions that give its table.
inline std::vector<StoredAnswer> PapersAnswers() {
  std::vector<StoredAnswer> answers(kPaperPeople, Stored("", Condition::kEmulated, 0));
  for (std::size_t i = 0; i < kStatements; ++i) {
    const PaperRow& row = PaperTable()[i];
    const ScoreCounts counts = MatchingCounts(row.figures, kPaperPeople, row.lowest).front();
    std::size_t person = 0;
    for (std::size_t s = 0; s < kScores; ++s)
      for (int k = 0; k < counts[s]; ++k)
        answers[person++].answer.scores[i] = kLowestScore + static_cast<int>(s);
  }
  for (std::size_t k = 0; k < answers.size(); ++k)
    answers[k].answer.pseudonym = "P" + std::to_string(k);
  return answers;
}

}  // namespace predictor
