// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "core/command_line.h"
#include "viewer/view_options.h"
#include "viewer/viewer_app.h"

int main(int argc, char** argv) {
  std::string model_file;
  lfm::ViewOptions view;
  lfm::ViewerOptions options;
  lfm::CommandLine command("lfm-viewer",
                           "Shows a model, or a scene of several, in a window: walk round it, see "
                           "what it is made of, hold it against its photographs, measure, film.",
                           "lfm-viewer demo/work/encode/model.glb --elevation 30");
  command.Positional("MODEL",
                     "The model, a .glb, .lfz or .wrl file; or a scene, a .json file "
                     "(docs/formats.md).",
                     model_file);
  command.Options(lfm::AnyOptions(view), "View");
  command.Options(lfm::AnyOptions(options), "Window");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    lfm::RunViewer(model_file, view, options, progress);
  });
}
