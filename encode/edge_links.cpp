// SPDX-License-Identifier: BSD-3-Clause
#include "encode/edge_links.h"

#include <algorithm>

#include "encode/shared_samples.h"

namespace lfm {
namespace {

Eigen::Vector2i SampleAt(int n, int edge, int step) {
  const int rest = n - 1 - step;
  if (edge == 0) return {step, 0};
  return edge == 1 ? Eigen::Vector2i(rest, step) : Eigen::Vector2i(0, rest);
}

std::array<int, 3> MeetingCorners(const Eigen::Vector3i& own, const Eigen::Vector3i& other) {
  std::array<int, 3> channels{};
  for (int c = 0; c < 3; ++c) {
    channels[c] = -1;
    for (int o = 0; o < 3; ++o) {
      if (other[o] == own[c]) channels[c] = o;
    }
  }
  return channels;
}

}  // namespace

std::vector<EdgeLink> FindEdgeLinks(const TriangleMesh& mesh, std::span<const int> edge_samples,
                                    PatchChannels channels) {
  std::vector<int> owners, sizes;
  std::vector<Eigen::Vector3i> triangles;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    if (edge_samples[t] == 0) continue;
    owners.push_back(t);
    triangles.push_back(mesh.triangles[t]);
    sizes.push_back(edge_samples[t]);
  }
  std::vector<EdgeLink> links;
  for (const SharedEdge& edge : FindSharedSamples(triangles, sizes).edges) {
    for (size_t u = 0; u < edge.uses.size() && edge.uses.size() > 1; ++u) {
      const EdgeUse& own = edge.uses[u];
      const EdgeUse& other = edge.uses[(u + 1) % edge.uses.size()];
      EdgeLink link;
      link.triangle = owners[own.patch];
      link.neighbor = owners[other.patch];
      if (channels == PatchChannels::kCorners) {
        link.channels = MeetingCorners(triangles[own.patch], triangles[other.patch]);
      }
      const int last = own.edge_samples - 1, other_last = other.edge_samples - 1;
      for (int step = 0; step <= last; ++step) {
        const int place = own.reversed == other.reversed ? step : last - step;
        const int before = std::min(place * other_last / last, other_last - 1);
        link.own = SampleAt(own.edge_samples, own.edge, step);
        for (int i = 0; i < 2; ++i) {
          link.other[i] = SampleAt(other.edge_samples, other.edge, before + i);
        }
        link.share = static_cast<float>(place * other_last) / static_cast<float>(last) -
                     static_cast<float>(before);
        links.push_back(link);
      }
    }
  }
  return links;
}

}  // namespace lfm
