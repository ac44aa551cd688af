// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_panel.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <numbers>
#include <utility>

namespace lfm {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
constexpr float kClickReach = 4;  // a press that moves less is a click
constexpr float kLetterPixels = 13;
constexpr float kPanelWidth = 110;
constexpr float kScriptFrameSeconds = 1.0f / 60;  // double clicks do not depend on the machine

// The script's hands instead of the user's.
void PutHands(const ScriptedInput& script, ImGuiIO& io) {
  io.DeltaTime = kScriptFrameSeconds;
  io.MousePos =
      ImVec2(static_cast<float>(script.pointer.x()), static_cast<float>(script.pointer.y()));
  io.MouseDown[ImGuiMouseButton_Left] = script.left;
  io.MouseDown[ImGuiMouseButton_Right] = script.right;
  io.MouseDown[ImGuiMouseButton_Middle] = script.middle;
  io.MouseWheelH = static_cast<float>(script.scroll.x());
  io.MouseWheel = static_cast<float>(script.scroll.y());
  io.KeyShift = script.shift;
  io.KeyCtrl = script.ctrl;
  io.KeyAlt = script.alt;
  std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
  if (script.key) io.KeysDown[*script.key] = true;
}

std::optional<DragMode> DragOf(const ImGuiIO& io) {
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 0)) {
    return io.KeyShift ? DragMode::kPan : io.KeyCtrl ? DragMode::kZoom : DragMode::kOrbit;
  }
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Right, 0)) return DragMode::kPan;
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 0)) return DragMode::kPan;
  return std::nullopt;
}

ViewerState ApplyMouse(ViewerState state, const ImGuiIO& io) {
  if (io.WantCaptureMouse || io.DisplaySize.y < 1) return state;
  const Eigen::Vector2d moved(io.MouseDelta.x, io.MouseDelta.y);
  const int height = static_cast<int>(io.DisplaySize.y);
  if (const auto drag = DragOf(io)) state = ApplyDrag(std::move(state), *drag, moved, height);
  ScrollInput scroll;
  scroll.steps = {io.MouseWheelH, io.MouseWheel};
  scroll.shift = io.KeyShift;
  scroll.ctrl = io.KeyCtrl;
  scroll.from_middle = {io.MousePos.x - io.DisplaySize.x / 2, io.MousePos.y - io.DisplaySize.y / 2};
  scroll.height = height;
  state = ApplyScroll(std::move(state), scroll);
  const bool twice = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  const bool once = ImGui::IsMouseReleased(ImGuiMouseButton_Left) &&
                    io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] < kClickReach * kClickReach &&
                    io.MouseClickedLastCount[ImGuiMouseButton_Left] < 2;
  if (once || twice) {
    state.click =
        PictureClick{{io.MousePos.x / io.DisplaySize.x, io.MousePos.y / io.DisplaySize.y}, twice};
  }
  return state;
}

bool Repeats(ViewerAction action) {
  return action >= ViewerAction::kTurnLeft && action <= ViewerAction::kFarther;
}

ViewerState ApplyKeys(ViewerState state, const ImGuiIO& io) {
  if (io.WantTextInput) return state;
  for (int key = 0; key <= GLFW_KEY_LAST; ++key) {
    const std::optional<ViewerAction> action = ActionOfKey(key, io.KeyShift);
    if (action && ImGui::IsKeyPressed(key, Repeats(*action))) {
      state = Apply(std::move(state), *action);
    }
  }
  return state;
}

template <typename Enum>
void Combo(const char* label, const char* names, Enum& value) {
  int index = static_cast<int>(value);
  if (ImGui::Combo(label, &index, names)) value = static_cast<Enum>(index);
}

ViewerState Do(ViewerState state, const char* button, ViewerAction action) {
  return ImGui::Button(button) ? Apply(std::move(state), action) : std::move(state);
}

ViewerState LayOutTerms(ViewerState state, const ViewerStatus& status) {
  ImGui::SliderInt("terms  [ ]", &state.terms, 0, state.model_terms);
  Combo("show  M T", "all up to it\0mean view\0this term alone\0", state.shown);
  Combo("passes", "one\0paper's\0paper's, unsigned\0", state.passes);
  if (state.passes != Passes::kOne) {
    ImGui::Text("%d passes", status.passes);
    ImGui::TextDisabled("without tone, edges, term alone");
  }
  Combo("view coordinates", "a pixel\0a vertex\0maps at corners\0", state.view_coordinates);
  return state;
}

ViewerState LayOutSurface(ViewerState state, const ViewerStatus& status) {
  Combo("surface  O", "light field\0normals\0photographs\0guessed directions\0terms\0patch sizes\0",
        state.overlay);
  for (const LegendEntry& entry : status.legend) {
    const ImVec4 color(entry.color[0], entry.color[1], entry.color[2], 1);
    ImGui::ColorButton(entry.text.c_str(), color, ImGuiColorEditFlags_NoTooltip);
    ImGui::SameLine();
    ImGui::TextUnformatted(entry.text.c_str());
  }
  bool wireframe = state.edges == EdgeOverlay::kWireframe;
  if (ImGui::Checkbox("wireframe  W", &wireframe)) {
    state = Apply(std::move(state), ViewerAction::kToggleWireframe);
  }
  auto exposure = static_cast<float>(state.tone.exposure_stops);
  if (ImGui::SliderFloat("exposure", &exposure, -4, 4, "%.1f stops")) {
    state.tone.exposure_stops = exposure;
  }
  Combo("tone", "clip\0soft\0", state.tone.curve);
  ImGui::ColorEdit3("background", state.background.data(), ImGuiColorEditFlags_NoInputs);
  return state;
}

ViewerState LayOutPhotographs(ViewerState state, const ViewerStatus& status) {
  ImGui::Checkbox("cameras  C", &state.show_cameras);
  if (ImGui::BeginCombo("from", state.photograph.empty() ? "anywhere" : state.photograph.c_str())) {
    if (ImGui::Selectable("anywhere", state.photograph.empty())) state.photograph.clear();
    for (const std::string& id : status.photographs) {
      if (ImGui::Selectable(id.c_str(), id == state.photograph)) state.photograph = id;
    }
    ImGui::EndCombo();
  }
  if (!status.photographs_have_pictures) return state;
  ImGui::Checkbox("beside the photograph  D", &state.show_photograph);
  if (state.show_photograph && state.photograph.empty()) {
    ImGui::TextDisabled("choose a photograph, or click a camera");
  }
  if (status.photograph_psnr_db) {
    ImGui::Text("%.2f dB%s", *status.photograph_psnr_db,
                status.photograph_held_out ? ", held out" : ", used in the fit");
  }
  return state;
}

ViewerState LayOutTools(ViewerState state, const ViewerStatus& status) {
  bool measure = state.tool == Tool::kMeasure;
  if (ImGui::Checkbox("measure  B", &measure)) {
    state = Apply(std::move(state), ViewerAction::kToggleTape);
  }
  if (const auto length = TapeLength(state)) {
    ImGui::SameLine();
    ImGui::Text("%.2f mm", *length);
  }
  if (status.film_share < 1) {
    ImGui::ProgressBar(static_cast<float>(status.film_share));
    if (ImGui::Button("stop")) state.stop_film = true;
    return state;
  }
  ImGui::InputInt("frames", &state.turntable_frames);
  state.turntable_frames = std::clamp(state.turntable_frames, 1, 100000);
  if (ImGui::Button("record turntable")) state.film = Film::kTurntable;
  state = Do(std::move(state), "add place K", ViewerAction::kAddPathKey);
  if (!state.path.keys.empty()) {
    ImGui::SameLine();
    ImGui::Text("%zu places", state.path.keys.size());
    state = Do(std::move(state), "remove", ViewerAction::kRemovePathKey);
    ImGui::SameLine();
    if (ImGui::Button("save path")) state.save_path = true;
    ImGui::SameLine();
    if (ImGui::Button("record")) state.film = Film::kPath;
  }
  return state;
}

// Numbers to drag, three in a row.
void DragNumbers(const char* label, Eigen::Vector3d& values, float speed) {
  Eigen::Vector3f shown = values.cast<float>();
  if (ImGui::DragFloat3(label, shown.data(), speed, 0, 0, "%.0f")) values = shown.cast<double>();
}

ViewerState LayOutModels(ViewerState state) {
  for (size_t i = 0; i < state.models.size(); ++i) {
    ShownModel& model = state.models[i];
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::TreeNode(model.name.c_str())) {
      DragNumbers("mm", model.translation, 1);
      DragNumbers("degrees", model.angles_deg, 1);
      auto scale = static_cast<float>(model.scale);
      if (ImGui::DragFloat("times", &scale, 0.01f, 0.01f, 100, "%.2f")) model.scale = scale;
      ImGui::TreePop();
    }
    ImGui::PopID();
  }
  if (ImGui::Button("save scene")) state.save_scene = true;
  return state;
}

void LayOutFrameTimes(const ViewerStatus& status) {
  if (status.frame_times_ms.empty()) return;
  std::vector<float> sorted = status.frame_times_ms;
  std::sort(sorted.begin(), sorted.end());
  const float median = sorted[sorted.size() / 2];
  char text[64];
  std::snprintf(text, sizeof(text), "%.1f ms, worst %.1f", median, sorted.back());
  ImGui::PlotLines("", status.frame_times_ms.data(), static_cast<int>(sorted.size()), 0, text, 0,
                   1.5f * sorted.back(), ImVec2(220, 60));
}

// Where the panel ends, at the window's left.
float RightEdge() {
  const float left = ImGui::GetWindowPos().x, right = left + ImGui::GetWindowWidth();
  return left < ImGui::GetIO().DisplaySize.x / 4 ? right : 0;
}

// A window that was small for a while pushed the panel out over its edges.
void StayInWindow() {
  const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  const ImVec2 room = ImGui::GetIO().DisplaySize;
  if ((at.x < 0 && size.x <= room.x) || (at.y < 0 && size.y <= room.y)) {
    ImGui::SetWindowPos(ImVec2(std::max(at.x, 0.f), std::max(at.y, 0.f)));
  }
}

ViewerState LayOutPanel(ViewerState state, const ViewerStatus& status, float scale,
                        float& right_edge) {
  ImGui::SetNextWindowPos(ImVec2(12, 12), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowBgAlpha(0.8f);
  ImGui::Begin("Light field", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  StayInWindow();
  ImGui::PushItemWidth(kPanelWidth * scale);
  state = LayOutTerms(std::move(state), status);
  if (ImGui::CollapsingHeader("Surface", ImGuiTreeNodeFlags_DefaultOpen)) {
    state = LayOutSurface(std::move(state), status);
  }
  if (!status.photographs.empty() &&
      ImGui::CollapsingHeader("Photographs", ImGuiTreeNodeFlags_DefaultOpen)) {
    state = LayOutPhotographs(std::move(state), status);
  }
  if (ImGui::CollapsingHeader("Tools")) state = LayOutTools(std::move(state), status);
  if (ImGui::CollapsingHeader("Models")) {
    state = LayOutModels(std::move(state));
    ImGui::Text("%zu triangles", status.triangles);
    ImGui::Checkbox("dropped files join these", &state.add_dropped);
  }
  if (ImGui::CollapsingHeader("Hands")) {
    Combo("scrolling", "automatic\0zooms\0turns\0", state.scrolling);
    ImGui::TextDisabled(
        "drag             turn\nright or shift   move\nctrl, scrolling  zoom\n"
        "double click     turn about it\narrows, + -      turn, zoom\nR, home          back\n"
        "P                this panel");
  }
  state = Do(std::move(state), "save S", ViewerAction::kSaveScreenshot);
  ImGui::SameLine();
  state = Do(std::move(state), "home R", ViewerAction::kGoHome);
  ImGui::SameLine();
  state = Do(std::move(state), "times G", ViewerAction::kToggleFrameTimes);
  ImGui::Text("azimuth %.0f  elevation %.0f", state.camera.azimuth * kDegreesPerRadian,
              state.camera.elevation * kDegreesPerRadian);
  if (state.show_frame_times) LayOutFrameTimes(status);
  ImGui::PopItemWidth();
  if (!state.message.empty()) ImGui::TextWrapped("%s", state.message.c_str());
  right_edge = RightEdge();
  ImGui::End();
  return state;
}

// In the middle of the picture, or at its lower edge: what is being read, and what could not be.
void LayOutNews(const ViewerStatus& status) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration |
                                      ImGuiWindowFlags_AlwaysAutoResize |
                                      ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav;
  if (status.loading_share < 1) {
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y - 12), ImGuiCond_Always, ImVec2(0.5f, 1));
    ImGui::Begin("reading", nullptr, kFlags);
    ImGui::TextUnformatted(status.loading_what.c_str());
    ImGui::ProgressBar(static_cast<float>(status.loading_share),
                       ImVec2(std::max(size.x / 3, 60.f), 0));
    ImGui::End();
  }
  if (!status.error.empty()) {
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2(std::max(size.x * 0.6f, 60.f), 0), ImGuiCond_Always);
    ImGui::Begin("fault", nullptr, kFlags & ~ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::TextWrapped("%s", status.error.c_str());
    ImGui::TextDisabled("Drop another model here.");
    ImGui::End();
  }
}

}  // namespace

ViewerPanel::ViewerPanel(const Window& window, double scale) : scale_(static_cast<float>(scale)) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // a viewer leaves no settings file behind
  ImGui::StyleColorsDark();
  ImGui::GetStyle().ScaleAllSizes(scale_);
  ImFontConfig font;
  font.SizePixels = kLetterPixels * scale_;
  ImGui::GetIO().Fonts->AddFontDefault(&font);
  ImGui_ImplGlfw_InitForOpenGL(window.handle(), true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

ViewerPanel::~ViewerPanel() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

ViewerState ViewerPanel::Update(ViewerState state, const ViewerStatus& status,
                                const std::optional<ScriptedInput>& script) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  if (script) PutHands(*script, ImGui::GetIO());
  ImGui::NewFrame();
  const ImGuiIO& io = ImGui::GetIO();
  state = ApplyKeys(ApplyMouse(std::move(state), io), io);
  float right_edge = 0;
  if (state.show_panel) state = LayOutPanel(std::move(state), status, scale_, right_edge);
  covered_share_ = io.DisplaySize.x > 0 ? right_edge / io.DisplaySize.x : 0;
  LayOutNews(status);
  return state;
}

void ViewerPanel::Draw() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace lfm
