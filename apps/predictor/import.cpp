#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.h"
#include "core/file.h"
#include "scenario/yaml_tree.h"
#include "tracks/person_file.h"

namespace predictor {

int ImportCommand(const ImportOptions& options) {
  namespace fs = std::filesystem;
  const std::string output = options.output.empty()
                                 ? fs::path(options.file).replace_extension(".person.csv").string()
                                 : options.output;
  options.CheckWritable();
  options.RefuseToReplace(output);
  const tracks::ImportMap map =
      tracks::ParseImportMap(ReadYamlText(options.map, "a mapping"), options.map);
  const tracks::SeriesFile file = tracks::ReadSeries(options.file, map.channels.TimeOf());
  WriteWholeFile(output, tracks::ImportPerson(map, file));
  const tracks::PersonFile written = tracks::ReadPersonFile(output);
  std::string text = "Wrote " + output + ". Next: predictor evaluate " + output + "\n";
  for (const std::string& note : written.header.notes) text += "Note: " + note + "\n";
  const nlohmann::ordered_json result = {{"file", output}, {"notes", written.header.notes}};
  options.Write(text, result.dump(2) + "\n");
  return kFinished;
}

}  // namespace predictor
