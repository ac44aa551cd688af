// SPDX-License-Identifier: BSD-3-Clause
// Figures 4 to 7 of Mahajan 2007 on our code: lfm-bench-mahajan [--data DIR] [--out DIR]. Charts go
// to the folder of --out (mahajan), a table of figures to standard output as Markdown. --data: a
// folder with the captures of the transport scenes (lfm-capture --scene NAME --out DIR/NAME);
// without it, what has a closed form.
#include <cstdio>
#include <string>

#include "bench/mahajan_report.h"
#include "core/command_line.h"

namespace {

struct Folders {
  std::string data, out = "mahajan";
  void Declare(lfm::OptionVisitor& v) {
    v.Text({"data", "Folder with a capture of each transport scene."}, data);
    v.Text({"out", "Folder for the charts."}, out);
  }
};

}  // namespace

int main(int argc, char** argv) {
  Folders folders;
  lfm::CommandLine command("lfm-bench-mahajan", "Redraws Figures 4 to 7 of Mahajan 2007.",
                           "lfm-bench-mahajan --data captures --out mahajan");
  command.Options(lfm::AnyOptions(folders));
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    lfm::MahajanReport report(folders.out);
    progress.Start("figures", 4);
    lfm::DrawFlatland(report);
    progress.Advance();
    lfm::DrawSpheres(report);
    progress.Advance();
    lfm::DrawClosedForms(report);
    progress.Advance();
    if (!folders.data.empty()) lfm::DrawCaptures(folders.data, report);
    progress.Advance();
    std::fputs(report.Table().c_str(), stdout);
  });
}
