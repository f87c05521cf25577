// Threads that run alongside the loop. An exception in such a thread must not end the process while
// the arms move.
#pragma once

#include <pthread.h>

#include <exception>
#include <thread>
#include <utility>

namespace predictor {

// Calls `work`. If the body of the thread throws, `failed` receives the reason as text. Exceptions
// that `failed` itself throws, for example when memory is exhausted, are discarded.
template <class Work, class Failed>
void Contain(const Work& work, const Failed& failed) noexcept {
  try {
    try {
      work();
    } catch (const std::exception& error) {
      failed(error.what());
    } catch (...) {
      failed("an exception of an unknown type");
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): nothing more can be done
  }
}

// A thread that contains every exception of its body. `name` has at most 15 characters and appears
// in `ps -L`.
template <class Work, class Failed>
std::thread ContainedThread(const char* name, Work work, Failed failed) {
  return std::thread([name, work = std::move(work), failed = std::move(failed)] {
    pthread_setname_np(pthread_self(), name);
    Contain(work, failed);
  });
}

}  // namespace predictor
