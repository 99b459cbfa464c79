#include "geodesics/exact/window_forecast.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace saddleback {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr std::size_t k_most_rings = 1 << 16;  ///< what is farther out goes into the last one
// What goes on from a bend ends sooner than its rays tell, as its windows are narrow and lie in others' way.
constexpr double k_from_bend = 0.5;
// As a share of a face's edge or, on needles, of its height: guessed distances are as exact as this. Usually they are
// more so, but on a sphere all are too short, and rays that end for that miss what comes last, where most windows are.
constexpr double k_doubt = 0.5;

constexpr double k_surely = 1 - 1e-9;  ///< of squared distances

/// A straight line from a root at (sx, sy), on its way into the half-edge's face at (x, 0).
struct Ray {
  double sx, sy, x, sigma;
  Index halfedge;
};

class RayCount {
 public:
  RayCount(const ExactSurface& surface, const std::vector<GuessedArrival>& arrivals,
           const WindowForecast::Extent& extent)
      : surface_(surface), arrivals_(arrivals), extent_(extent) {}

  void add_vertex(Index vertex, double weight) {
    const GuessedArrival& arrival = arrivals_[vertex];
    const bool bends = surface_.may_bend(vertex);
    count(arrival.distance, (extent_.windows_at_vertex + (bends ? extent_.windows_at_bend : 0)) * weight);
    if (arrival.halfedge == GuessedArrival::k_at_source) return;
    const Index original = surface_.mesh_vertex(vertex);
    const double total = surface_.mesh().total_angle(original), angle = arrival_angle(vertex);
    if (!bends) {
      follow(ray_from(vertex, std::fmod(angle + total / 2, total)), weight);
    } else if (!surface_.mesh().is_boundary(original)) {
      // What it cones anew lies between two rays.
      follow(ray_from(vertex, std::fmod(angle + k_pi, total)), k_from_bend * weight);
      follow(ray_from(vertex, std::fmod(angle + total - k_pi, total)), k_from_bend * weight);
    } else {
      if (angle + k_pi < total) follow(ray_from(vertex, angle + k_pi), k_from_bend * weight);
      if (angle - k_pi > 0) follow(ray_from(vertex, angle - k_pi), k_from_bend * weight);
    }
  }

  /// What a source inside a face cones through each edge stays one window until vertices split it; of its rays the one
  /// straight ahead lasts about longest.
  void add_source(const SourceInFace& place, double weight) {
    for (Index h = 3 * place.face; h < 3 * place.face + 3; ++h) {
      const Index entered = surface_.twin(h);
      const double length = surface_.frame(h).length;
      const Vec2 center = surface_.in_frame(h, place.barycentric);
      if (entered != k_none && center.y() > 0)
        follow({length - center.x(), -center.y(), std::clamp(length - center.x(), 0.0, length), 0, entered}, weight);
    }
  }

  std::vector<double> sums() {
    counts_.insert(counts_.begin(), 0.0);
    std::partial_sum(counts_.begin(), counts_.end(), counts_.begin());
    return std::move(counts_);
  }

 private:
  void count(double distance, double windows) {
    const auto ring =
        static_cast<std::size_t>(std::min(distance / extent_.ring_width, static_cast<double>(k_most_rings)));
    if (ring >= counts_.size()) counts_.resize(ring + 1, 0.0);
    counts_[ring] += windows;
  }

  template <class Visit>
  void for_corners(Index vertex, Visit&& visit) const {
    const Mesh& mesh = surface_.mesh();
    const Index first = mesh.first_halfedge(surface_.mesh_vertex(vertex));
    Index h = first;
    double angle = 0;
    do {
      const double corner = mesh.corner_angle(h);
      if (visit(surface_.halfedge_of(h), angle, corner)) return;
      angle += corner;
      h = mesh.rotate(h);
    } while (h != k_none && h != first);
  }

  double arrival_angle(Index vertex) const {
    const GuessedArrival& arrival = arrivals_[vertex];
    double result = 0;
    for_corners(vertex, [&](Index out, double angle, double corner) {
      if (arrival.halfedge == GuessedArrival::k_along_edge) {
        result = angle;
        if (surface_.frame(out).to == arrival.from) return true;
        result = angle + corner;  // along the last edge of a boundary vertex
        return false;
      }
      if (out != Mesh::prev(arrival.halfedge)) return false;
      const EdgeFrame& frame = surface_.frame(arrival.halfedge);
      const double turn = std::atan2(frame.apex_x * arrival.y - frame.apex_y * arrival.x,
                                     frame.apex_x * arrival.x + frame.apex_y * arrival.y);
      result = angle + std::clamp(turn, 0.0, corner);
      return true;
    });
    return result;
  }

  Ray ray_from(Index vertex, double direction) const {
    Ray ray{0, 0, 0, arrivals_[vertex].sigma, k_none};
    for_corners(vertex, [&](Index out, double angle, double corner) {
      if (direction > angle + corner) return false;
      const EdgeFrame &frame = surface_.frame(out), &opposite = surface_.frame(Mesh::next(out));
      const double after = direction - angle, a = frame.length * std::sin(after),
                   c = frame.left_length * std::sin(corner - after);
      const double length = frame.right_length, x = length * (c / (a + c));  // from the apex on
      const double px = length - opposite.apex_x, py = -opposite.apex_y;
      const double dx = x - px, dy = -py;
      const double back = (arrivals_[vertex].distance - ray.sigma) / std::sqrt(dx * dx + dy * dy);
      ray = {px - back * dx, py - back * dy, x, ray.sigma, frame.right};
      return true;
    });
    return ray;
  }

  /// Until some corner has a shorter way, or a source.
  void follow(Ray ray, double weight) {
    constexpr int k_most_steps = 1 << 16;
    for (int step = 0; step < k_most_steps && ray.halfedge != k_none; ++step) {
      const EdgeFrame& frame = surface_.frame(ray.halfedge);
      const double dx = ray.x - ray.sx, length = ray.sigma + std::sqrt(dx * dx + ray.sy * ray.sy);
      const double least = length - k_doubt * std::min(frame.length, frame.apex_y);
      const bool is_first = length <= extent_.limit && least <= arrivals_[frame.from].distance + ray.x &&
                            least <= arrivals_[frame.to].distance + (frame.length - ray.x);
      if (!is_first || is_nearer_to_source(ray, length)) return;
      count(length, weight);
      const double ox = frame.apex_x - ray.sx, oy = frame.apex_y - ray.sy;
      if (!(oy > 0)) return;
      if (ray.x < ray.sx - ox * (ray.sy / oy)) {
        turn(ray, frame.left_length, frame.apex_x, frame.apex_y);
        ray.halfedge = frame.left;
      } else {
        ray.sx = frame.length - ray.sx;
        ray.x = frame.length - ray.x;
        turn(ray, frame.right_length, frame.length - frame.apex_x, frame.apex_y);
        ray.sx = frame.right_length - ray.sx;
        ray.x = frame.right_length - ray.x;
        ray.halfedge = frame.right;
      }
    }
  }

  /// Than to the ray's root, from where the ray crosses its half-edge.
  bool is_nearer_to_source(const Ray& ray, double length) const {
    bool result = false;
    surface_.for_sources_beside(ray.halfedge, [&](const SourceBeside& other) {
      const double dx = other.place.x() - ray.x;
      result = result || dx * dx + other.place.y() * other.place.y() < k_surely * length * length;
    });
    return result;
  }

  /// Onto the edge from the origin to (ax, ay), which is its x axis then.
  static void turn(Ray& ray, double length, double ax, double ay) {
    const double ux = ax / length, uy = ay / length;
    const double divisor = uy * (ray.sx - ray.x) - ray.sy * ux;
    ray.x = divisor > 0 ? std::min(-ray.sy * ray.x / divisor, length) : length;
    const double sx = ray.sx, sy = ray.sy;
    ray.sx = ux * sx + uy * sy;
    ray.sy = std::min(0.0, ux * sy - uy * sx);
  }

  const ExactSurface& surface_;
  const std::vector<GuessedArrival>& arrivals_;
  const WindowForecast::Extent extent_;
  std::vector<double> counts_{0.0};
};

}  // namespace

WindowForecast::WindowForecast(const ExactSurface& surface, const SurfacePoints& sources, const Extent& extent,
                               const JobStage& stage) {
  constexpr double k_guess = 0.8;  // share of the time
  constexpr std::size_t k_samples = 1000, k_samples_a_check = 16;
  const std::vector<GuessedArrival> arrivals =
      guessed_arrivals(surface, sources, {extent.limit, extent.vertices}, stage.part(0, k_guess));
  std::vector<Index> reached;
  for (Index v = 0; v < surface.vertex_count(); ++v)
    if (!std::isinf(arrivals[v].distance)) reached.push_back(v);
  const std::size_t stride = std::max<std::size_t>(1, reached.size() / k_samples);
  RayCount rays(surface, arrivals, extent);
  const JobStage following = stage.part(k_guess, 1);
  for (std::size_t i = stride / 2; i < reached.size(); i += stride) {
    if (i / stride % k_samples_a_check == 0)
      following.update(static_cast<double>(i) / static_cast<double>(reached.size()));
    rays.add_vertex(reached[i], static_cast<double>(stride));
  }
  const std::span<const SourceInFace> places = surface.sources_in_faces();
  const std::size_t apart = std::max<std::size_t>(1, places.size() / k_samples);
  for (std::size_t i = apart / 2; i < places.size(); i += apart) rays.add_source(places[i], static_cast<double>(apart));
  counts_ = rays.sums();
}

}  // namespace saddleback
