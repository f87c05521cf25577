// Files that the tests make up.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor::tracks {

class Files : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& content) const {
    const std::string file = folder_.path() / name;
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }
  const test::TemporaryFolder folder_;
};

// Returns the message of the InputError that `action` throws.
template <class Action>
std::string ErrorOf(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// Expects each of the words in the message.
inline void ExpectWords(const std::string& message, std::initializer_list<const char*> words) {
  for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
}

}  // namespace predictor::tracks
