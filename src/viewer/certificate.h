// The certificate that a headset or another machine is shown.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

struct Certificate {
  std::string certificate_pem, key_pem;  // chain and private key
  std::string fingerprint;               // SHA-256 of the first certificate: "AB:CD:..."
  std::vector<std::string> names;        // its subjectAltName: host names and addresses
  bool made = false;                     // just now
};

// This machine's host names and IPv4 addresses, "localhost" and loopback first.
std::vector<std::string> MachineNames();

// A self-signed certificate (P-256, two years) for `names`, kept in `folder` as viewer.pem and
// viewer.key, both readable by the owner alone. The one that is there is taken if it covers all
// names for another 30 days; else a new one is made. Throws InputError, naming the file.
Certificate SelfSignedCertificate(const std::filesystem::path& folder,
                                  const std::vector<std::string>& names);

// The user's own, checked: the key belongs to the certificate and its time has not run out.
// Throws InputError.
Certificate ReadCertificate(const std::filesystem::path& certificate,
                            const std::filesystem::path& key);

}  // namespace predictor
