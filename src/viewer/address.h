// Addresses that the page is served on.
#pragma once

#include <string>

namespace predictor {

bool IsAddress(const std::string& text);  // of IPv4 or IPv6, in numbers
// Of IPv4 or IPv6, in numbers: reached from this machine alone. Anything else is not.
bool IsLoopback(const std::string& address);

}  // namespace predictor
