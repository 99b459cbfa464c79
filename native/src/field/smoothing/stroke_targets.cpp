#include "field/smoothing/stroke_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "saddleback/error.h"

namespace saddleback {
namespace {

constexpr double k_turn = 2 * std::numbers::pi;
/// Bounds the difference of two hard strokes in a face that agree: the rounding of curves drawn twice.
constexpr double k_agreement = 1e-6;

/// Collects what a stroke does in each face: the mean of its directions there, each turned by less than half a quantum.
class FacesOfStroke {
 public:
  explicit FacesOfStroke(double quantum) : quantum_(quantum) {}

  void add(Index face, double angle, double length) {
    const auto [at, is_new] = place_.try_emplace(face, faces_.size());
    if (is_new) {
      faces_.push_back({face, angle, length});
      return;
    }
    StrokeFace& known = faces_[at->second];
    known.stiffness += length;
    known.angle += std::remainder(angle - known.angle, quantum_) * length / known.stiffness;
  }
  /// Tells whether it has been in the face before, along another direction.
  bool disagrees(Index face, double angle) const {
    const auto at = place_.find(face);
    return at != place_.end() && std::abs(std::remainder(angle - faces_[at->second].angle, quantum_)) > k_agreement;
  }
  /// Returns the faces with lengths in place of stiffness.
  StrokeFaces take() { return std::move(faces_); }

 private:
  double quantum_;
  StrokeFaces faces_;
  std::map<Index, std::size_t> place_;
};

StrokeFaces faces_of(const Mesh& mesh, const Stroke& stroke, std::size_t number, int symmetry) {
  FacesOfStroke faces(k_turn / symmetry);
  Index last = k_none;
  for (const CurveSegment& segment : stroke.curve.segments()) {
    const FaceChart chart(mesh, segment.face);
    const Vec2 along = chart.to_plane(segment.end) - chart.to_plane(segment.begin);
    const double angle = std::atan2(along.y(), along.x());
    if (stroke.is_hard && segment.face != last && faces.disagrees(segment.face, angle))
      throw InputError(message("strokes: the hard stroke ", number, " crosses itself in face ", segment.face,
                               ", where it wants different directions; make it soft"));
    last = segment.face;
    faces.add(segment.face, angle, segment.length);
  }
  StrokeFaces result = faces.take();
  for (StrokeFace& face : result) {
    const double size = std::sqrt(2 * mesh.face_area(face.face));
    face.stiffness =
        stroke.is_hard ? k_fixed
                       : k_drawn_stiffness * weight_within_bounds(stroke.weight) * std::min(1.0, face.stiffness / size);
  }
  return result;
}

/// Returns the faces along a loop: fixed to it; those with two boundary edges have a spring to the mean.
StrokeFaces faces_of_loop(const Mesh& mesh, const std::vector<Index>& loop, int symmetry) {
  FacesOfStroke faces(k_turn / symmetry);
  std::map<Index, int> edges;
  for (const Index v : loop) {
    const Index h = mesh.first_halfedge(v);  // the boundary edge that leaves v, the surface on its left
    faces.add(Mesh::face_of(h), chart_angle(mesh, h), mesh.length(h));
    ++edges[Mesh::face_of(h)];
  }
  StrokeFaces result = faces.take();
  for (StrokeFace& face : result) face.stiffness = edges[face.face] == 1 ? k_fixed : k_drawn_stiffness;
  return result;
}

void check_strokes(const Mesh& mesh, std::span<const Stroke> strokes) {
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    if (&strokes[i].curve.mesh() != &mesh) throw InputError(message("strokes: stroke ", i, " lies on another mesh"));
    const double weight = strokes[i].weight;
    if (!(weight > 0) || !std::isfinite(weight))
      throw InputError(message("strokes: stroke ", i, " has weight ", weight, ", but it must be positive and finite"));
  }
}

void check_hard_strokes(std::span<const StrokeFaces> strokes, int symmetry) {
  std::map<Index, std::pair<std::size_t, double>> fixed;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    for (const StrokeFace& face : strokes[i]) {
      if (face.stiffness != k_fixed) continue;
      const auto [at, is_new] = fixed.try_emplace(face.face, i, face.angle);
      const auto [other, angle] = at->second;
      if (!is_new && std::abs(std::remainder(angle - face.angle, k_turn / symmetry)) > k_agreement)
        throw InputError(message("strokes: the hard strokes ", other, " and ", i, " cross in face ", face.face,
                                 ", where they want different directions; make one of them soft"));
    }
  }
}

/// Strokes tied together, the nearest first, each time by the whole quanta that make the smallest step between them.
class StrokeForest {
 public:
  StrokeForest(const Mesh& mesh, double quantum, std::vector<StrokeFaces>& strokes)
      : mesh_(mesh), quantum_(quantum), strokes_(strokes), tree_(strokes.size()) {
    std::iota(tree_.begin(), tree_.end(), std::size_t{0});
  }

  void tie() {
    spread();
    std::vector<Link> links = find_links();
    std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.distance < b.distance; });
    for (const Link& link : links) {
      const std::size_t keep = tree_[link.a.stroke], move = tree_[link.b.stroke];
      if (keep == move) continue;
      const double step = strokes_[link.b.stroke][link.b.place].angle - strokes_[link.a.stroke][link.a.place].angle;
      const double shift = -quantum_ * std::round(step / quantum_);
      for (std::size_t s = 0; s < strokes_.size(); ++s) {
        if (tree_[s] != move) continue;
        tree_[s] = keep;
        for (StrokeFace& face : strokes_[s]) face.angle += shift;
      }
    }
  }

 private:
  struct Source {
    std::size_t stroke, place;
  };
  struct Link {
    Index distance;
    Source a, b;
  };

  /// Every face learns the stroke face that it is nearest to, counted in faces.
  void spread() {
    sources_.reserve(64);
    source_of_.assign(mesh_.face_count(), k_none);
    distance_.assign(mesh_.face_count(), 0);
    std::vector<Index> queue;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      for (std::size_t p = 0; p < strokes_[s].size(); ++p) {
        const Index face = strokes_[s][p].face;
        if (source_of_[face] != k_none) {
          crossings_.push_back({0, sources_[source_of_[face]], {s, p}});
          continue;
        }
        source_of_[face] = static_cast<Index>(sources_.size());
        sources_.push_back({s, p});
        queue.push_back(face);
      }
    }
    for (std::size_t read = 0; read < queue.size(); ++read) {
      for (Index h = 3 * queue[read]; h < 3 * queue[read] + 3; ++h) {
        if (mesh_.twin(h) == k_none) continue;
        const Index next = Mesh::face_of(mesh_.twin(h));
        if (source_of_[next] != k_none) continue;
        source_of_[next] = source_of_[queue[read]];
        distance_[next] = distance_[queue[read]] + 1;
        queue.push_back(next);
      }
    }
  }

  std::vector<Link> find_links() const {
    std::vector<Link> links = crossings_;
    for (const Index h : inner_edges(mesh_)) {
      const Index f = Mesh::face_of(h), g = Mesh::face_of(mesh_.twin(h));
      if (source_of_[f] == k_none) continue;
      const Source &a = sources_[source_of_[f]], &b = sources_[source_of_[g]];
      if (a.stroke != b.stroke) links.push_back({distance_[f] + distance_[g] + 1, a, b});
    }
    return links;
  }

  const Mesh& mesh_;
  const double quantum_;
  std::vector<StrokeFaces>& strokes_;
  std::vector<std::size_t> tree_;
  std::vector<Source> sources_;
  std::vector<Index> source_of_, distance_;
  std::vector<Link> crossings_;
};

template <class Scalar>
void add_spring(FaceSprings<Scalar>& springs, const StrokeFace& face, Scalar target) {
  double& stiffness = springs.stiffness[face.face];
  if (stiffness == k_fixed) return;
  if (face.stiffness == k_fixed) {
    springs.target[face.face] = target;
  } else {
    springs.target[face.face] += (target - springs.target[face.face]) * face.stiffness / (stiffness + face.stiffness);
  }
  stiffness += face.stiffness;
}

}  // namespace

std::vector<StrokeFaces> stroke_faces(const Mesh& mesh, int symmetry, std::span<const Stroke> strokes,
                                      bool along_boundary) {
  check_strokes(mesh, strokes);
  std::vector<StrokeFaces> result;
  for (const Stroke& stroke : strokes) result.push_back(faces_of(mesh, stroke, result.size(), symmetry));
  check_hard_strokes(result, symmetry);
  if (along_boundary)
    for (const std::vector<Index>& loop : mesh.boundary_loops()) result.push_back(faces_of_loop(mesh, loop, symmetry));
  return result;
}

FaceSprings<double> turning_springs(const Mesh& mesh, int symmetry, std::span<const double> angles,
                                    const std::vector<StrokeFaces>& strokes) {
  const double quantum = k_turn / symmetry;
  std::vector<StrokeFaces> wanted = strokes;
  for (StrokeFaces& stroke : wanted) {
    for (std::size_t i = 0; i < stroke.size(); ++i) {
      double angle = stroke[i].angle - angles[stroke[i].face];
      if (i > 0) angle -= quantum * std::round((angle - stroke[i - 1].angle) / quantum);
      stroke[i].angle = angle;
    }
  }
  StrokeForest(mesh, quantum, wanted).tie();
  FaceSprings<double> result(mesh);
  for (const StrokeFaces& stroke : wanted)
    for (const StrokeFace& face : stroke) add_spring(result, face, face.angle);
  return result;
}

FaceSprings<std::complex<double>> power_springs(const Mesh& mesh, int symmetry,
                                                const std::vector<StrokeFaces>& strokes) {
  FaceSprings<std::complex<double>> result(mesh);
  for (const StrokeFaces& stroke : strokes)
    for (const StrokeFace& face : stroke) add_spring(result, face, std::polar(1.0, symmetry * face.angle));
  return result;
}

}  // namespace saddleback
