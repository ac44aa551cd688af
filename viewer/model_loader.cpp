// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/model_loader.h"

#include <algorithm>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <thread>
#include <utility>

#include "core/atomic_file.h"
#include "encode/glb.h"
#include "encode/transport_form.h"

namespace lfm {
namespace {

// Of the time that a .glb takes, about.
constexpr double kShareOfMeanView = 0.2;

std::vector<std::string> NamesOf(const std::vector<SceneEntry>& entries) {
  std::map<std::filesystem::path, std::set<std::filesystem::path>> files;
  for (const SceneEntry& entry : entries) files[entry.file.filename()].insert(entry.file);
  std::vector<std::string> names;
  for (const SceneEntry& entry : entries) {
    const std::filesystem::path name = entry.file.filename();
    const bool told_apart = !name.empty() && files[name].size() == 1;
    names.push_back(told_apart ? name.string() : entry.file.string());
  }
  return names;
}

// What of the work an entry is.
double WeightOf(const SceneEntry& entry) {
  std::error_code missing;
  const uintmax_t bytes = std::filesystem::file_size(entry.file, missing);
  return missing ? 1 : 1 + static_cast<double>(bytes);
}

std::string NoteOf(const std::filesystem::path& file, const std::string& problem) {
  std::string note = problem.starts_with(file.string()) ? problem : file.string() + ": " + problem;
  std::replace_if(
      note.begin(), note.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return note;
}

// Why reading failed; called where the exception is being handled.
std::string NoteOfException(const std::filesystem::path& file) {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return NoteOf(file, "there is not enough memory for it; show fewer or smaller models");
  } catch (const std::exception& error) {
    return NoteOf(file, error.what());
  } catch (...) {
    return NoteOf(file, "cannot be read, for a reason that is not known");
  }
}

}  // namespace

struct ModelLoader::State {
  explicit State(std::vector<SceneEntry> wanted)
      : entries(std::move(wanted)), names(NamesOf(entries)) {
    for (const SceneEntry& entry : entries) weights.push_back(WeightOf(entry));
    for (const double weight : weights) all_weight += weight;
    thread = std::jthread([this](const std::stop_token& stop) { ReadAll(stop); });
  }

  void ReadAll(const std::stop_token& stop) {
    std::map<std::filesystem::path, std::weak_ptr<const LightFieldModel>> known;
    for (size_t i = 0; i < entries.size() && !stop.stop_requested(); ++i) {
      const std::filesystem::path& file = entries[i].file;
      try {
        std::shared_ptr<const LightFieldModel> model = known[file].lock();
        std::string note;
        if (!model) {
          DecodedModel read = Read(i, stop);
          if (read.parts_missing > 0) note = NoteOf(file, CutOffNote(file, read));
          model = std::make_shared<const LightFieldModel>(std::move(read.model));
        }
        known[file] = model;
        Deliver(i, std::move(model), note);
      } catch (...) {
        Deliver(i, nullptr, NoteOfException(file));
      }
    }
  }

  // The whole model; delivers its mean view on the way.
  DecodedModel Read(size_t i, const std::stop_token& stop) {
    const std::filesystem::path& file = entries[i].file;
    {
      const std::string bytes = ReadFile(file), name = file.string();
      if (bytes.starts_with("glTF")) {
        DeliverMeanView(i, ReadGlbBytes(bytes, name, GlbContent::kMeanView));
        if (stop.stop_requested()) return {};  // for nobody
        return {ReadGlbBytes(bytes, name), 0};
      }
    }
    return ReadModel(file);
  }

  Arrival ArrivalOf(size_t i, std::shared_ptr<const LightFieldModel> model) const {
    return {i, {names[i], std::move(model), entries[i].placement}, true, ""};
  }

  void DeliverMeanView(size_t i, LightFieldModel model) {
    Arrival arrival = ArrivalOf(i, std::make_shared<const LightFieldModel>(std::move(model)));
    arrival.whole = false;
    const std::lock_guard lock(mutex);
    arrivals.push_back(std::move(arrival));
    read_weight = done_weight + kShareOfMeanView * weights[i];
  }

  void Deliver(size_t i, std::shared_ptr<const LightFieldModel> model, const std::string& note) {
    Arrival arrival = ArrivalOf(i, std::move(model));
    arrival.note = note;
    const std::lock_guard lock(mutex);
    arrivals.push_back(std::move(arrival));
    read_weight = done_weight += weights[i];
    done = i + 1;
  }

  // These do not change once the thread runs.
  const std::vector<SceneEntry> entries;
  const std::vector<std::string> names;
  std::vector<double> weights;
  double all_weight = 0;

  std::mutex mutex;  // of what follows
  std::deque<Arrival> arrivals;
  size_t done = 0;  // entries
  double done_weight = 0, read_weight = 0;

  std::jthread thread;  // the last: it ends before the rest goes
};

ModelLoader::ModelLoader(std::vector<SceneEntry> entries)
    : state_(std::make_unique<State>(std::move(entries))) {}

ModelLoader::~ModelLoader() = default;

std::optional<ModelLoader::Arrival> ModelLoader::Next() {
  const std::lock_guard lock(state_->mutex);
  if (state_->arrivals.empty()) return std::nullopt;
  Arrival arrival = std::move(state_->arrivals.front());
  state_->arrivals.pop_front();
  return arrival;
}

bool ModelLoader::Done() const {
  const std::lock_guard lock(state_->mutex);
  return state_->done == state_->entries.size() && state_->arrivals.empty();
}

double ModelLoader::Share() const {
  const std::lock_guard lock(state_->mutex);
  if (state_->done == state_->entries.size()) return 1;
  return std::min(1.0, state_->read_weight / state_->all_weight);
}

std::string ModelLoader::What() const {
  const std::lock_guard lock(state_->mutex);
  return state_->done < state_->entries.size() ? state_->names[state_->done] : "";
}

}  // namespace lfm
