// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/poisson.h"

#include <fcntl.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <mutex>
#include <string>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

// PCL prints a line on standard output for a cell that it could not close; the repair afterwards
// deals with those, and nobody who runs a command should read about them. PCL's Poisson code calls
// printf: neither its verbosity nor std::cout's buffer reaches that, and only the descriptor does.
// So the process's standard output leads nowhere while PCL works: what another thread prints in
// that time is lost, which is why this stands around that one call, one thread at a time, and puts
// everything back however the call ends. Where no descriptor is free, PCL may be heard.
class SilentStandardOutput {
 public:
  SilentStandardOutput() : lock_(Mutex()) {
    std::cout.flush();
    std::fflush(stdout);
    saved_ = dup(STDOUT_FILENO);
    if (saved_ < 0) return;
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;
    dup2(nowhere, STDOUT_FILENO);
    close(nowhere);
  }
  ~SilentStandardOutput() {
    if (saved_ < 0) return;
    std::fflush(stdout);
    dup2(saved_, STDOUT_FILENO);
    close(saved_);
  }
  SilentStandardOutput(const SilentStandardOutput&) = delete;
  SilentStandardOutput& operator=(const SilentStandardOutput&) = delete;

 private:
  static std::mutex& Mutex() {
    static std::mutex mutex;
    return mutex;
  }

  std::lock_guard<std::mutex> lock_;
  int saved_ = -1;
};

}  // namespace

TriangleMesh ReconstructPoisson(const PointCloud& points, const PoissonSettings& settings) {
  if (points.points.empty()) throw Error("reconstruction: there are no points");
  // PCL computes in float32: far from the origin that would cost digits.
  Eigen::Vector3d low = points.points.front(), high = low;
  for (const Eigen::Vector3d& p : points.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3d center = 0.5 * (low + high);
  pcl::PointCloud<pcl::PointNormal>::Ptr cloud(new pcl::PointCloud<pcl::PointNormal>);
  cloud->reserve(points.points.size());
  for (size_t i = 0; i < points.points.size(); ++i) {
    pcl::PointNormal p;
    p.getVector3fMap() = (points.points[i] - center).cast<float>();
    p.getNormalVector3fMap() = points.normals[i].cast<float>();
    cloud->push_back(p);
  }
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setDepth(settings.depth);
  poisson.setScale(static_cast<float>(settings.cube_scale));
  poisson.setSamplesPerNode(static_cast<float>(settings.samples_per_node));
  poisson.setPointWeight(static_cast<float>(settings.point_weight));
  poisson.setConfidence(true);
  poisson.setManifold(false);
  poisson.setThreads(1);
  poisson.setInputCloud(cloud);

  pcl::PointCloud<pcl::PointNormal> vertices;
  std::vector<pcl::Vertices> polygons;
  try {
    const SilentStandardOutput silence;
    poisson.performReconstruction(vertices, polygons);
  } catch (const std::exception& e) {
    throw Error(std::string("reconstruction: Poisson failed: ") + e.what(), ErrorKind::kSystem);
  }
  TriangleMesh mesh;
  mesh.vertices.reserve(vertices.size());
  for (const pcl::PointNormal& v : vertices) {
    mesh.vertices.push_back(v.getVector3fMap().cast<double>() + center);
  }
  for (const pcl::Vertices& polygon : polygons) {
    const auto& corners = polygon.vertices;
    for (size_t k = 2; k < corners.size(); ++k) {
      mesh.triangles.emplace_back(corners[0], corners[k - 1], corners[k]);
    }
  }
  if (mesh.triangles.empty()) {
    throw Error("reconstruction: no surface came out; do the normals point towards the scanner?");
  }
  return mesh;
}

}  // namespace lfm
