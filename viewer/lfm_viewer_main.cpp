// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "core/command_line.h"
#include "encode/transport_form.h"
#include "viewer/view_options.h"
#include "viewer/viewer_app.h"

int main(int argc, char** argv) {
  std::string model_file;
  lfm::ViewOptions view;
  lfm::ViewerOptions options;
  lfm::CommandLine command("lfm-viewer",
                           "Shows a model in a window: walk round it, change the number of terms, "
                           "save pictures.",
                           "lfm-viewer demo/work/encode/model.glb --elevation 30");
  command.Positional("MODEL", "The model, a .glb, .lfz or .wrl file.", model_file);
  command.Options(lfm::AnyOptions(view), "View");
  command.Options(lfm::AnyOptions(options), "Window");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const lfm::DecodedModel decoded = lfm::ReadModel(model_file);
    if (decoded.parts_missing > 0) progress.Note(lfm::CutOffNote(model_file, decoded));
    lfm::RunViewer(decoded.model, view, options);
  });
}
