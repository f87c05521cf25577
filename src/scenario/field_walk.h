// The kinds of members in a field table. Visitors of the table treat these kinds differently.
#pragma once

#include <optional>
#include <type_traits>
#include <vector>

#include "scenario/fields.h"

namespace predictor {

template <class T, class V>
concept IsStruct = requires(V& v, T& s) {
  Fields(v, s);
};

template <class T>
struct OptionalTraits : std::false_type {};
template <class T>
struct OptionalTraits<std::optional<T>> : std::true_type {};
template <class T>
concept IsOptional = OptionalTraits<T>::value;

template <class T, class V>
struct StructListTraits : std::false_type {};
template <class T, class V>
requires IsStruct<T, V>
struct StructListTraits<std::vector<T>, V> : std::true_type {
};
template <class T, class V>
concept IsStructList = StructListTraits<T, V>::value;

// A rule for an enumeration, whose values are words in a file.
template <class E>
Rule WordRule(Rule rule) {
  rule.choices = NamesOf(E{});
  return rule;
}

}  // namespace predictor
