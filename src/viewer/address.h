// Addresses on which the page is served.
#pragma once

#include <string>

namespace predictor::viewer {

bool IsAddress(const std::string& text);  // numeric IPv4 or IPv6
// Returns whether a numeric IPv4 or IPv6 address can be reached only from this machine, or false
// for any other text.
bool IsLoopback(const std::string& address);
// Returns the address under which a machine's attempts are counted. All loopback addresses are
// counted as one address. An IPv4 address mapped into IPv6 is counted as the IPv4 address. Other
// IPv6 addresses are counted by their network ("2001:db8::/64"), because one machine may use all
// addresses of its network. Link-local addresses are counted one by one, because their network is
// the same everywhere. A zone ("%eth0") is removed.
std::string SourceOf(const std::string& address);

}  // namespace predictor::viewer
