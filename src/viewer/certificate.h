// Provides the certificate that the viewer presents to headsets and other machines.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor::viewer {

struct Certificate {
  std::string certificate_pem, key_pem;  // chain and private key
  std::string fingerprint;               // SHA-256 of the first certificate: "AB:CD:..."
  std::vector<std::string> names;        // names in its subjectAltName: host names and addresses
  bool made = false;                     // made by this call
};

// Returns this machine's host names and IPv4 addresses, with "localhost" and loopback first.
std::vector<std::string> MachineNames();

// Reads the TLS library's configuration, which cannot be read later.
void InitialiseTls();

// Throws InputError if the folder cannot be created, or if other users may change its contents.
void MakeCertificateFolder(const std::filesystem::path& folder);

// Returns a self-signed certificate (P-256, two years) for `names`, kept in `folder` as viewer.pem
// and viewer.key. Only the owner can read these files. An existing certificate is used if it covers
// all names and is valid for at least 30 more days. If there is no such certificate, a new one is
// made. Throws InputError with the file's name.
Certificate SelfSignedCertificate(const std::filesystem::path& folder,
                                  const std::vector<std::string>& names);

// Reads the user's own certificate. Checks that the key belongs to the certificate and that the
// certificate has not expired. Throws InputError.
Certificate ReadCertificate(const std::filesystem::path& certificate,
                            const std::filesystem::path& key);

}  // namespace predictor::viewer
