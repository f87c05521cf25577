// predictor forget: deletes everything of one person.
#include "recording/forget.h"

#include <unistd.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "screen.h"

namespace predictor {
namespace {

constexpr const char* kNotReached =
    "This command does not remove backups or snapshots of the file system, copies in other folders "
    "or on other computers, or exports to which you gave names without the pseudonym. The command "
    "also does not overwrite deleted blocks of a disk (an SSD keeps some blocks that no program "
    "can reach).";

void PrintList(const std::string& title, const std::vector<PersonalFile>& list) {
  if (list.empty()) return;
  TheScreen().Print(title);
  for (const PersonalFile& entry : list)
    TheScreen().Print("  " + entry.path.string() + ": " + entry.why);
}

bool Confirmed(const ForgetOptions& options, std::size_t count) {
  if (options.yes) return true;
  if (isatty(STDIN_FILENO) != 1)
    throw InputError("Nothing was deleted. To delete the listed files, add --yes.");
  TheScreen().Print(Formatted("Files to delete for good: %zu. To delete them, type yes.", count));
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "yes";
}

PersonSearch Search(const ForgetOptions& options) {
  const PersonSearch result =
      FindPerson(options.folder, options.pseudonym, [&](std::uint64_t files) {
        if (!options.quiet && files % 64 == 0)
          TheScreen().Bar(Formatted("Searching: %zu files", std::size_t{files}));
      });
  TheScreen().Bar("");
  return result;
}

// The result contains neither the names of the files nor the pseudonym.
void WriteResult(const ForgetOptions& options, std::size_t deleted, const PersonSearch& after) {
  const std::size_t left = after.found.size();
  std::string text = Formatted("Files deleted: %zu. ", deleted);
  text += left == 0 ? Formatted("The remaining files (%zu) do not contain the pseudonym.\n",
                                std::size_t{after.files})
                    : Formatted("Files that remain: %zu, listed above.\n", left);
  if (!after.not_searched.empty())
    Append(&text, "Places not searched: %zu, listed above. Search them yourself.\n",
           after.not_searched.size());
  const nlohmann::ordered_json json = {{"deleted", deleted},
                                       {"left", left},
                                       {"searched_files", after.files},
                                       {"not_searched", after.not_searched.size()},
                                       {"not_reached", kNotReached}};
  options.Write(text + kNotReached + "\n", json.dump(2) + "\n");
}

}  // namespace

int ForgetCommand(const ForgetOptions& options) {
  options.CheckWritable();
  const PersonSearch before = Search(options);
  PrintList("Files of this person:", before.found);
  PrintList("These files also have other names outside of the folder (hard links):", before.linked);
  if (!before.found.empty() && !Confirmed(options, before.found.size())) {
    TheScreen().Print("Nothing was deleted.");
    return kUnfit;
  }
  const std::vector<PersonalFile> failed = Delete(before.found);
  PrintList("Could not be deleted:", failed);
  const PersonSearch after = Search(options);
  PrintList("Not searched:", after.not_searched);
  PrintList("Remaining:", after.found);
  WriteResult(options, before.found.size() - failed.size(), after);
  const bool all = after.found.empty() && after.not_searched.empty() && before.linked.empty();
  return all ? kFinished : kUnfit;
}

}  // namespace predictor
