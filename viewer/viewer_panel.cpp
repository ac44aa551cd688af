// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_panel.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <numbers>
#include <utility>

namespace lfm {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

constexpr std::pair<int, ViewerAction> kKeys[] = {
    {GLFW_KEY_M, ViewerAction::kToggleMeanOnly},
    {GLFW_KEY_W, ViewerAction::kToggleWireframe},
    {GLFW_KEY_RIGHT_BRACKET, ViewerAction::kMoreTerms},
    {GLFW_KEY_LEFT_BRACKET, ViewerAction::kFewerTerms},
    {GLFW_KEY_S, ViewerAction::kSaveScreenshot},
    {GLFW_KEY_R, ViewerAction::kResetView},
    {GLFW_KEY_P, ViewerAction::kTogglePanel},
    {GLFW_KEY_ESCAPE, ViewerAction::kQuit}};

ViewerState ApplyMouse(ViewerState state, const ImGuiIO& io) {
  if (io.WantCaptureMouse) return state;
  const Eigen::Vector2d moved(io.MouseDelta.x, io.MouseDelta.y);
  const int height = static_cast<int>(io.DisplaySize.y);
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 0)) {
    state = ApplyDrag(std::move(state), DragMode::kOrbit, moved, height);
  }
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Right, 0)) {
    state = ApplyDrag(std::move(state), DragMode::kPan, moved, height);
  }
  if (io.MouseWheel != 0) state = ApplyWheel(std::move(state), io.MouseWheel);
  return state;
}

ViewerState ApplyKeys(ViewerState state, const ImGuiIO& io) {
  if (io.WantTextInput) return state;
  for (const auto& [key, action] : kKeys) {
    if (ImGui::IsKeyPressed(key, false)) state = Apply(std::move(state), action);
  }
  return state;
}

ViewerState LayOut(ViewerState state, float frames_per_second) {
  ImGui::SetNextWindowPos(ImVec2(12, 12), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowBgAlpha(0.8f);
  ImGui::Begin("Light field", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::SetNextItemWidth(110);
  ImGui::SliderInt("terms  [ ]", &state.terms, 0, state.model_terms);
  ImGui::Checkbox("mean view only  M", &state.mean_only);
  bool wireframe = state.edges == EdgeOverlay::kWireframe;
  if (ImGui::Checkbox("wireframe  W", &wireframe)) {
    state = Apply(std::move(state), ViewerAction::kToggleWireframe);
  }
  auto where = static_cast<int>(state.view_coordinates);
  ImGui::SetNextItemWidth(110);
  if (ImGui::Combo("view coordinates", &where, "a pixel\0a vertex\0maps at corners\0")) {
    state.view_coordinates = static_cast<ViewCoordinates>(where);
  }
  if (ImGui::Button("save S")) state.save_screenshot = true;
  ImGui::SameLine();
  if (ImGui::Button("reset R")) state.camera = state.home;
  ImGui::Text("azimuth %.0f  elevation %.0f", state.camera.azimuth * kDegreesPerRadian,
              state.camera.elevation * kDegreesPerRadian);
  ImGui::Text("%.0f frames/s", frames_per_second);
  ImGui::TextDisabled("left drag  orbit\nwheel      zoom\nright drag pan\nP          panel");
  if (!state.message.empty()) ImGui::TextWrapped("%s", state.message.c_str());
  ImGui::End();
  return state;
}

}  // namespace

ViewerPanel::ViewerPanel(const Window& window) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // a viewer leaves no settings file behind
  ImGui::StyleColorsDark();
  ImGui_ImplGlfw_InitForOpenGL(window.handle(), true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

ViewerPanel::~ViewerPanel() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

ViewerState ViewerPanel::Update(ViewerState state) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  const ImGuiIO& io = ImGui::GetIO();
  state = ApplyKeys(ApplyMouse(std::move(state), io), io);
  if (state.show_panel) state = LayOut(std::move(state), io.Framerate);
  return state;
}

void ViewerPanel::Draw() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace lfm
