# SPDX-License-Identifier: BSD-3-Clause
# Writes OUT, a source file that holds the text of every JSON file in DIR by its name:
#   cmake -D DIR=... -D OUT=... -P EmbedScenes.cmake
file(GLOB scenes ${DIR}/*.json)
list(SORT scenes)
set(entries "")
foreach(scene ${scenes})
  get_filename_component(name ${scene} NAME_WE)
  file(READ ${scene} text)
  string(APPEND entries "      {\"${name}\", R\"scene(${text})scene\"},\n")
endforeach()
file(WRITE ${OUT} "// SPDX-License-Identifier: BSD-3-Clause
#include \"sample_data/builtin_scenes.h\"

namespace lfm {

const std::map<std::string, std::string>& BuiltinSceneTexts() {
  static const std::map<std::string, std::string> texts = {
${entries}  };
  return texts;
}

}  // namespace lfm
")
