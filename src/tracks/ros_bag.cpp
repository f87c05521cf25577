// Reads the topics of ROS 2 bags in both storage formats.
#include <sqlite3.h>
#include <zstd.h>

#include <map>
#include <memory>

#include "core/error.h"
#include "core/text.h"
#include "recording/mcap.h"
#include "tracks/ros_messages.h"

namespace predictor::tracks {
namespace {

using mcap::Op;
using mcap::Parser;

constexpr std::uint64_t kMaxChunk = std::uint64_t{1} << 28U;  // uncompressed [bytes]

// The topics, each with its number in the storage file.
class Topics {
 public:
  Topics(std::string file, MessageTime clock) : file_(std::move(file)), clock_(clock) {}

  void Announce(std::int64_t id, const std::string& topic, const std::string& type,
                const std::string& encoding) {
    if (encoding == "cdr" && RosTopic::IsKnown(type))
      topics_.try_emplace(id, topic, type);
    else if (topics_.find(id) == topics_.end())
      others_[id] = topic + " (" + type + (encoding == "cdr" ? "" : ", " + encoding) + ")";
  }
  void Add(std::int64_t id, std::string_view bytes, std::int64_t received) {
    const auto found = topics_.find(id);
    if (found == topics_.end()) return;
    try {
      found->second.Add(bytes, received, clock_);
    } catch (const InputError& error) {
      throw InputError(file_, error.what());
    }
  }
  SeriesFile Finish() {
    SeriesFile result;
    result.name = file_;
    for (auto& [id, topic] : topics_) topic.Finish(file_, &result.series);
    std::vector<std::string> left_out;
    for (const auto& [id, words] : others_) left_out.push_back(words);
    if (!left_out.empty())
      result.warnings.push_back("Topics of other types are not read: " + Printable(Join(left_out)) +
                                ".");
    if (result.series.empty())
      throw InputError(file_,
                       "The bag has no topic that can be read, such as WrenchStamped, "
                       "PoseStamped or JointState. It has: " +
                           (left_out.empty() ? "nothing" : Printable(Join(left_out))) + ".");
    return result;
  }

 private:
  std::string file_;
  MessageTime clock_;
  std::map<std::int64_t, RosTopic> topics_;
  std::map<std::int64_t, std::string> others_;
};

// ---- MCAP -------------------------------------------------------------------------------------

class McapBag {
 public:
  McapBag(const std::string& file, Topics* topics) : file_(file), topics_(topics) {}

  void Read(std::string_view bytes) {
    if (!bytes.starts_with(mcap::kMagic))
      Fail("This is not an MCAP file. Give a recording of ROS 2 in MCAP or SQLite, or a CSV file.");
    ReadRecords(bytes.substr(mcap::kMagic.size()), false);
  }

 private:
  [[noreturn]] void Fail(const std::string& sentence) const { throw InputError(file_, sentence); }

  // The file may end with its final magic or be cut off. The reader uses all complete records.
  void ReadRecords(std::string_view rest, bool in_chunk) {
    for (Parser parser{rest}; parser.rest.size() >= mcap::kHead;) {
      const auto op = static_cast<Op>(parser.Number<std::uint8_t>());
      const std::string_view content = parser.Take(parser.U64());
      if (!parser.ok || op == Op::kDataEnd) return;
      if (op == Op::kSchema) AddSchema(Parser{content});
      if (op == Op::kChannel) AddChannel(Parser{content});
      if (op == Op::kMessage) AddMessage(Parser{content});
      if (op == Op::kChunk && !in_chunk) ReadChunk(Parser{content});
    }
  }

  void AddSchema(Parser p) {
    const std::uint16_t id = p.U16();
    const std::string name(p.String());
    if (p.ok) schemas_[id] = name;
  }

  void AddChannel(Parser p) {
    const std::uint16_t id = p.U16(), schema = p.U16();
    const std::string topic(p.String()), encoding(p.String());
    if (p.ok) topics_->Announce(id, topic, schemas_[schema], encoding);
  }

  void AddMessage(Parser p) {
    const std::uint16_t channel = p.U16();
    p.U32();
    const std::uint64_t received = p.U64();
    p.U64();
    if (p.ok) topics_->Add(channel, p.rest, static_cast<std::int64_t>(received));
  }

  void ReadChunk(Parser p) {
    p.U64();
    p.U64();
    const std::uint64_t size = p.U64();
    const std::uint32_t crc = p.U32();
    const std::string_view compression = p.String();
    const std::string_view records = p.Take(p.U64());
    if (!p.ok || size > kMaxChunk)
      Fail("A chunk is damaged. Record the bag again, or repair the file.");
    std::string unpacked;
    std::string_view plain = records;
    if (compression == mcap::kZstd) {
      unpacked.resize(size);
      const std::size_t n =
          ZSTD_decompress(unpacked.data(), unpacked.size(), records.data(), records.size());
      if (ZSTD_isError(n) != 0 || n != size) Fail("A chunk is damaged and cannot be unpacked.");
      plain = unpacked;
    } else if (!compression.empty()) {
      Fail("Its chunks are compressed by " + Quote(compression) +
           ", which cannot be read. Convert the file: mcap compress --compression zstd.");
    }
    if (crc != 0 && mcap::Crc(plain) != crc) Fail("A chunk is damaged: its CRC is wrong.");
    ReadRecords(plain, true);
  }

  std::string file_;
  Topics* topics_;
  std::map<std::uint16_t, std::string> schemas_;
};

// ---- SQLite -----------------------------------------------------------------------------------

class SqliteBag {
 public:
  explicit SqliteBag(const std::string& file) : file_(file) {
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) Fail();
  }

  void Read(Topics* topics) {
    const auto text = [](sqlite3_stmt* row, int column) {
      const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
      return std::string(bytes == nullptr ? "" : bytes);
    };
    Each("SELECT id, name, type, serialization_format FROM topics", [&](sqlite3_stmt* row) {
      topics->Announce(sqlite3_column_int64(row, 0), text(row, 1), text(row, 2), text(row, 3));
    });
    Each("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp",
         [&](sqlite3_stmt* row) {
           const auto* data = static_cast<const char*>(sqlite3_column_blob(row, 2));
           const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, 2));
           topics->Add(sqlite3_column_int64(row, 0),
                       data == nullptr ? std::string_view() : std::string_view(data, size),
                       sqlite3_column_int64(row, 1));
         });
  }

 private:
  struct Close {
    void operator()(sqlite3* x) const { sqlite3_close(x); }
    void operator()(sqlite3_stmt* x) const { sqlite3_finalize(x); }
  };

  [[noreturn]] void Fail() const {
    throw InputError(file_, std::string("The file cannot be read as a ROS 2 bag (SQLite): ") +
                                sqlite3_errmsg(database_.get()) + ".");
  }

  template <class F>
  void Each(const char* query, F f) {
    sqlite3_stmt* prepared = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query, -1, &prepared, nullptr) != SQLITE_OK) Fail();
    const std::unique_ptr<sqlite3_stmt, Close> statement(prepared);
    int result = 0;
    while ((result = sqlite3_step(prepared)) == SQLITE_ROW) f(prepared);
    if (result != SQLITE_DONE) Fail();
  }

  std::string file_;
  std::unique_ptr<sqlite3, Close> database_;
};

// Returns the storage file in a bag's folder.
std::filesystem::path FileIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".db3" || entry.path().extension() == ".mcap")
      found.push_back(entry.path());
  if (found.size() == 1) return found[0];
  throw InputError(folder.string(),
                   found.empty() ? "The folder has no .db3 or .mcap file."
                                 : "The folder has several .db3 or .mcap files. Name one of them.");
}

}  // namespace

SeriesFile ReadRosBag(const std::filesystem::path& given, MessageTime clock) {
  const std::filesystem::path file = std::filesystem::is_directory(given) ? FileIn(given) : given;
  Topics topics(file.string(), clock);
  if (file.extension() == ".mcap") {
    const std::string bytes = ReadBytes(file);
    McapBag(file.string(), &topics).Read(bytes);
  } else {
    ReadBytes(file);  // checks that the file exists, is not empty and is not too large
    SqliteBag(file.string()).Read(&topics);
  }
  return topics.Finish();
}

}  // namespace predictor::tracks
