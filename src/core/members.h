// Visits the members of an aggregate in declaration order, so that no separate list of the members
// is needed.
#pragma once

#include <cstddef>

namespace predictor {

struct AnyMember {
  template <class T>
  operator T&() const;  // never defined; used only in unevaluated expressions
};

template <class T, class... Members>
consteval std::size_t MemberCount() {
  if constexpr (requires { T{Members{}..., AnyMember{}}; })
    return MemberCount<T, Members..., AnyMember>();
  else
    return sizeof...(Members);
}

// Calls visit(a, b, ...) with all members of x (at most 16).
template <class T, class Visit>
constexpr void VisitMembers(T& x, Visit&& visit) {
  constexpr std::size_t n = MemberCount<T>();
  static_assert(n == 1 || n == 2 || n == 3 || n == 4 || n == 10 || n == 11 || n == 13 || n == 14 ||
                    n == 15 || n == 16,
                "write a branch for this number of members below");
  if constexpr (n == 1) {
    auto& [a] = x;
    visit(a);
  } else if constexpr (n == 2) {
    auto& [a, b] = x;
    visit(a, b);
  } else if constexpr (n == 3) {
    auto& [a, b, c] = x;
    visit(a, b, c);
  } else if constexpr (n == 4) {
    auto& [a, b, c, d] = x;
    visit(a, b, c, d);
  } else if constexpr (n == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = x;
    visit(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (n == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = x;
    visit(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (n == 13) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = x;
    visit(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (n == 14) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o] = x;
    visit(a, b, c, d, e, f, g, h, i, j, k, l, m, o);
  } else if constexpr (n == 15) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o, p] = x;
    visit(a, b, c, d, e, f, g, h, i, j, k, l, m, o, p);
  } else {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q] = x;
    visit(a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q);
  }
}

}  // namespace predictor
