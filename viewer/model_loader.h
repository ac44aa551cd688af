// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/scene.h"

namespace lfm {

/// Reads a scene's models on a thread of its own, so that a window stays alive: of each .glb first
/// the mean view, then all of it. Nothing that goes wrong there is thrown: it becomes a note. The
/// functions below are for one thread.
class ModelLoader {
 public:
  /// Begins to read `entries` one after the other. A file that stands among them more than once is
  /// read once, as long as somebody holds its model.
  explicit ModelLoader(std::vector<SceneEntry> entries);
  /// Waits for the view or model that is being read; what follows it is not read.
  ~ModelLoader();
  ModelLoader(const ModelLoader&) = delete;
  ModelLoader& operator=(const ModelLoader&) = delete;

  /// Something that was read since the last call.
  struct Arrival {
    size_t entry = 0;  ///< index into the entries
    /// Named after its file, with folders where another entry's has the same name. model.model is
    /// empty when reading it failed; a mean view that came before may still be shown.
    PlacedModel model;
    bool whole = true;  ///< false: the mean view alone, the rest follows
    std::string note;   ///< one line for the user: why it failed, or what is missing; may be empty
  };
  /// The oldest that has not been asked for; never waits.
  std::optional<Arrival> Next();

  bool Done() const;         ///< everything has been read, and asked for
  double Share() const;      ///< of the work that has been read, by bytes of files; [0, 1]
  std::string What() const;  ///< name of what is being read; empty when nothing is any more

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
