#include "viewer/certificate.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "viewer/address.h"

namespace predictor::viewer {
namespace {

namespace fs = std::filesystem;

constexpr long kLife = 2 * 365 * 24 * 3600L;  // [s]
constexpr long kSoon = 30 * 24 * 3600L;       // a certificate with less time left is replaced [s]
constexpr std::uintmax_t kMaxCertificateBytes = 1u << 20;

template <auto Free>
struct Freer {
  template <class T>
  void operator()(T* it) const {
    Free(it);
  }
};
using X509Ptr = std::unique_ptr<X509, Freer<X509_free>>;
using KeyPtr = std::unique_ptr<EVP_PKEY, Freer<EVP_PKEY_free>>;
using BioPtr = std::unique_ptr<BIO, Freer<BIO_free_all>>;
using ExtensionPtr = std::unique_ptr<X509_EXTENSION, Freer<X509_EXTENSION_free>>;
using NamesPtr = std::unique_ptr<GENERAL_NAMES, Freer<GENERAL_NAMES_free>>;

std::string ReadText(const fs::path& file) {
  std::error_code error;
  if (fs::file_size(file, error) > kMaxCertificateBytes || error)
    throw InputError(file.string(),
                     "This file does not contain a certificate or key in PEM format.");
  return ReadWholeFile(file, kMaxCertificateBytes);
}

X509Ptr ParseCertificate(const std::string& pem) {
  const BioPtr bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  return X509Ptr(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr));
}

KeyPtr ParseKey(const std::string& pem) {
  const BioPtr bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  // A key with a passphrase causes an error instead of a prompt, because the console may be
  // unattended.
  const auto no_passphrase = [](char*, int, int, void*) { return 0; };
  return KeyPtr(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_passphrase, nullptr));
}

std::string Fingerprint(const X509* certificate) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int bytes = 0;
  if (X509_digest(certificate, EVP_sha256(), digest, &bytes) != 1) return {};
  std::string text;
  for (unsigned int i = 0; i < bytes; ++i) {
    char hex[4];
    std::snprintf(hex, sizeof hex, "%s%02X", i ? ":" : "", digest[i]);
    text += hex;
  }
  return text;
}

std::string NameOf(const GENERAL_NAME* name) {
  int type = 0;
  const void* value = GENERAL_NAME_get0_value(name, &type);
  const auto* bytes = static_cast<const ASN1_STRING*>(value);
  if (type == GEN_DNS)
    return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(bytes)),
            static_cast<std::size_t>(ASN1_STRING_length(bytes))};
  char text[INET6_ADDRSTRLEN] = "";
  if (type == GEN_IPADD)
    inet_ntop(ASN1_STRING_length(bytes) == 4 ? AF_INET : AF_INET6, ASN1_STRING_get0_data(bytes),
              text, sizeof text);
  return text;
}

std::vector<std::string> NamesOf(const X509* certificate) {
  std::vector<std::string> names;
  const NamesPtr list(static_cast<GENERAL_NAMES*>(
      X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)));
  for (int i = 0; list && i < sk_GENERAL_NAME_num(list.get()); ++i)
    names.push_back(NameOf(sk_GENERAL_NAME_value(list.get(), i)));
  return names;
}

bool AddExtension(X509* certificate, int nid, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const ExtensionPtr extension(X509V3_EXT_conf_nid(nullptr, &context, nid, value.c_str()));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

// Accepts letters, digits, dots and hyphens, which have no special meaning in a list of names.
bool IsHostName(const std::string& name) {
  return !name.empty() && name.size() <= 253 &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '.' || c == '-'; });
}

// Returns nullptr on an error of OpenSSL.
X509Ptr Sign(EVP_PKEY* key, const std::vector<std::string>& names) {
  X509Ptr certificate(X509_new());
  std::uint64_t serial = 0;
  if (!certificate || RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) != 1)
    return nullptr;
  X509* x = certificate.get();
  std::vector<std::string> entries;
  entries.reserve(names.size());
  for (const std::string& name : names)
    entries.push_back((IsAddress(name) ? "IP:" : "DNS:") + name);
  X509_NAME* subject = X509_get_subject_name(x);
  const auto* common = reinterpret_cast<const unsigned char*>("PREDICTOR viewer");
  const bool good =
      X509_set_version(x, 2) == 1 &&
      ASN1_INTEGER_set_uint64(X509_get_serialNumber(x), serial >> 1 | 1) == 1 &&
      X509_gmtime_adj(X509_getm_notBefore(x), -3600) &&  // allows for clocks that are slightly slow
      X509_gmtime_adj(X509_getm_notAfter(x), kLife) && X509_set_pubkey(x, key) == 1 &&
      X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC, common, -1, -1, 0) == 1 &&
      X509_set_issuer_name(x, subject) == 1 &&
      AddExtension(x, NID_basic_constraints, "critical,CA:FALSE") &&
      AddExtension(x, NID_key_usage, "critical,digitalSignature") &&
      AddExtension(x, NID_ext_key_usage, "serverAuth") &&
      AddExtension(x, NID_subject_alt_name, Join(entries, ",")) &&
      X509_sign(x, key, EVP_sha256()) > 0;
  return good ? std::move(certificate) : nullptr;
}

std::string Text(const BioPtr& bio) {
  char* data = nullptr;
  const long bytes = BIO_get_mem_data(bio.get(), &data);
  return {data, static_cast<std::size_t>(bytes)};
}

Certificate Make(const std::vector<std::string>& names) {
  const KeyPtr key(EVP_EC_gen("P-256"));
  const X509Ptr certificate = key ? Sign(key.get(), names) : nullptr;
  const BioPtr certificate_text(BIO_new(BIO_s_mem())), key_text(BIO_new(BIO_s_mem()));
  if (!certificate || PEM_write_bio_X509(certificate_text.get(), certificate.get()) != 1 ||
      PEM_write_bio_PrivateKey(key_text.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) !=
          1)
    throw InputError("A certificate could not be created for: " + Join(names) +
                     ". Give your own certificate with --certificate and --key.");
  return {Text(certificate_text), Text(key_text), Fingerprint(certificate.get()), names, true};
}

// Writes a temporary file and renames it, so that other processes never see or read an incomplete
// file.
void WriteSecret(const fs::path& file, const std::string& text) {
  const fs::path draft = file.string() + ".new";
  std::error_code ignored;
  fs::remove(draft, ignored);
  const int descriptor = open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool written = descriptor >= 0 && write(descriptor, text.data(), text.size()) ==
                                              static_cast<ssize_t>(text.size());
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (!written || rename(draft.c_str(), file.c_str()) != 0)
    throw InputError(file.string(), "The certificate could not be stored: " +
                                        std::string(std::strerror(written ? errno : error)) + ".");
}

bool IsOthersToo(const fs::path& file, unsigned beyond) {
  struct stat status {};
  return stat(file.c_str(), &status) == 0 &&
         (status.st_uid != geteuid() || (status.st_mode & beyond) != 0);
}

bool Covers(const std::vector<std::string>& have, const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return std::find(have.begin(), have.end(), name) != have.end();
  });
}

bool EndsWithin(const X509* certificate, long seconds) {
  time_t then = std::time(nullptr) + seconds;
  return X509_cmp_time(X509_get0_notAfter(certificate), &then) <= 0;
}

}  // namespace

void InitialiseTls() { OPENSSL_init_ssl(0, nullptr); }

// Another user with write access to the folder could place a known key there.
void MakeCertificateFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw InputError(folder.string(), "The folder for the certificate could not be created: " +
                                          error.message() + ".");
  if (IsOthersToo(folder, S_IWGRP | S_IWOTH))
    throw InputError(
        folder.string(),
        "The certificate's key would be stored here, where other users can change it. Set "
        "XDG_STATE_HOME to a folder of your own, or remove the other users' permissions.");
}

std::vector<std::string> MachineNames() {
  std::vector<std::string> names = {"localhost", "127.0.0.1", "::1"};
  const auto add = [&names](const std::string& name) {
    if ((IsHostName(name) || IsAddress(name)) &&
        std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  };
  char host[256] = "";
  if (gethostname(host, sizeof host - 1) == 0 && host[0] != '\0') {
    add(host);
    if (std::strchr(host, '.') == nullptr) add(std::string(host) + ".local");
  }
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return names;
  for (const ifaddrs* it = list; it != nullptr; it = it->ifa_next) {
    if (it->ifa_addr == nullptr || it->ifa_addr->sa_family != AF_INET ||
        (it->ifa_flags & IFF_UP) == 0)
      continue;
    char text[INET_ADDRSTRLEN] = "";
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(it->ifa_addr)->sin_addr, text,
              sizeof text);
    add(text);
  }
  freeifaddrs(list);
  return names;
}

Certificate ReadCertificate(const fs::path& certificate, const fs::path& key) {
  Certificate read{ReadText(certificate), ReadText(key), {}, {}, false};
  const X509Ptr x = ParseCertificate(read.certificate_pem);
  if (!x)
    throw InputError(certificate.string(),
                     "This file does not contain a certificate in PEM format.");
  const KeyPtr private_key = ParseKey(read.key_pem);
  if (!private_key)
    throw InputError(
        key.string(),
        "This file does not contain a private key in PEM format without a passphrase.");
  if (X509_check_private_key(x.get(), private_key.get()) != 1)
    throw InputError(key.string(), "The key does not belong to " + certificate.string() + ".");
  if (EndsWithin(x.get(), 0))
    throw InputError(certificate.string(), "The certificate has expired. Renew it.");
  read.fingerprint = Fingerprint(x.get());
  read.names = NamesOf(x.get());
  return read;
}

Certificate SelfSignedCertificate(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (!IsHostName(name) && !IsAddress(name))
      throw InputError(Quote(name) + " is neither a host name nor an address.");
  const fs::path certificate = folder / "viewer.pem", key = folder / "viewer.key";
  MakeCertificateFolder(folder);
  std::error_code error;
  // A key that others can read is not secret, so it is replaced.
  if (fs::exists(certificate, error) && fs::exists(key, error) &&
      !IsOthersToo(key, S_IRWXG | S_IRWXO)) {
    try {
      Certificate kept = ReadCertificate(certificate, key);
      if (Covers(kept.names, names) &&
          !EndsWithin(ParseCertificate(kept.certificate_pem).get(), kSoon))
        return kept;
    } catch (const InputError&) {  // damaged or expired: replace it
    }
  }
  Certificate made = Make(names);
  WriteSecret(key, made.key_pem);
  WriteSecret(certificate, made.certificate_pem);
  return made;
}

}  // namespace predictor::viewer
