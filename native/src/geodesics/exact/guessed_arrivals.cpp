#include "geodesics/exact/guessed_arrivals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geodesics/unfolding/common_length.h"
#include "support/block_queue.h"

namespace saddleback {
namespace {

// Ways that are shorter by less, relatively, are not followed up. What is too long by more turns the roots that needles
// tell of to quite other directions.
constexpr double k_shorter = 1e-9;

struct Due {
  Index vertex;
  double distance;
};

class Guess {
 public:
  Guess(const ExactSurface& surface, const GuessExtent& extent)
      : surface_(surface),
        extent_(extent),
        queue_(common_length(surface.mesh())),
        arrivals_(surface.vertex_count(), {std::numeric_limits<double>::infinity(), 0, 0, 0,
                                           GuessedArrival::k_at_source, k_none, k_none, k_none}) {}

  void start(const SurfacePoints& sources) {
    for (Index i = 0; i < static_cast<Index>(sources.size()); ++i) {
      const Index vertex = vertex_at(surface_.mesh(), sources[i]);
      if (vertex != k_none)
        offer(surface_.vertex_of(vertex), {0, 0, 0, 0, GuessedArrival::k_at_source, k_none, i, k_none});
    }
    for (const SourceInFace& place : surface_.sources_in_faces()) {
      for (Index h = 3 * place.face; h < 3 * place.face + 3; ++h) {
        const EdgeFrame& frame = surface_.frame(h);
        const Vec2 to_apex = Vec2(frame.apex_x, frame.apex_y) - surface_.in_frame(h, place.barycentric);
        offer(frame.apex, {to_apex.norm(), 0, to_apex.x(), to_apex.y(), h, k_none, place.source, k_none});
      }
    }
  }

  std::vector<GuessedArrival> run(const JobStage& stage) {
    while (queue_.advance())
      while (ItemBlock<Due>* block = queue_.take())
        while (block) block = drain(block, stage);
    return std::move(arrivals_);
  }

 private:
  /// \return the next of the chain.
  ItemBlock<Due>* drain(ItemBlock<Due>* block, const JobStage& stage) {
    stage.update(static_cast<double>(reached_) / std::max(1.0, extent_.vertices));
    for (Index i = 0; i < block->size; ++i) {
      const auto [vertex, distance] = block->items[i];
      if (arrivals_[vertex].distance == distance) go_on(vertex);
    }
    ItemBlock<Due>* const next = block->next;
    queue_.give_back(block);
    return next;
  }

  void offer(Index vertex, const GuessedArrival& arrival) {
    GuessedArrival& known = arrivals_[vertex];
    if (arrival.distance >= known.distance * (1 - k_shorter) || arrival.distance > extent_.limit) return;
    reached_ += std::isinf(known.distance);
    known = arrival;
    queue_.push({vertex, arrival.distance}, arrival.distance);
  }

  void go_on(Index vertex) {
    const Index first = surface_.halfedge_of(surface_.mesh().first_halfedge(surface_.mesh_vertex(vertex)));
    Index h = first;
    do {
      const EdgeFrame& frame = surface_.frame(h);
      along_edge(vertex, frame.to, frame.length);
      if (frame.left == k_none) along_edge(vertex, frame.apex, frame.left_length);
      through_face(h);
      through_face(Mesh::prev(h));
      h = frame.left;
    } while (h != k_none && h != first);
  }

  void along_edge(Index from, Index to, double length) {
    const GuessedArrival& before = arrivals_[from];
    const bool bends = surface_.may_bend(from) && before.halfedge != GuessedArrival::k_at_source;
    const double sigma = bends ? before.distance : before.sigma;
    const Index root = bends ? from : before.root;
    offer(to, {before.distance + length, sigma, 0, 0, GuessedArrival::k_along_edge, from, before.source, root});
  }

  /// The last vertex that both ways bend at; k_none where that is the source. Ways from two roots side by side told of
  /// one that is much too near.
  Index common_root(Index a, Index b) const {
    constexpr int k_most_steps = 16;
    for (int step = 0; step < k_most_steps && a != b; ++step) {
      const bool goes_on = b == k_none || (a != k_none && arrivals_[a].distance > arrivals_[b].distance);
      Index& later = goes_on ? a : b;
      later = arrivals_[later].root;
    }
    return a == b ? a : k_none;
  }

  /// To the apex, from the common root of both ends of the half-edge, which is as far from them as they say.
  void through_face(Index h) {
    const EdgeFrame& frame = surface_.frame(h);
    const GuessedArrival &a = arrivals_[frame.from], &b = arrivals_[frame.to];
    if (a.source != b.source || a.source == k_none) return;
    if (arrivals_[frame.apex].distance <= std::min(a.distance, b.distance)) return;
    const Index root = common_root(a.root, b.root);
    const double sigma = root == k_none ? 0 : arrivals_[root].distance;
    const double to_a = a.distance - sigma, to_b = b.distance - sigma;
    const double x = ((to_a - to_b) * (to_a + to_b) / frame.length + frame.length) / 2;
    const double y = -std::sqrt(std::max(0.0, (to_a - x) * (to_a + x)));
    const double ox = frame.apex_x - x, oy = frame.apex_y - y;
    const double crossing = x - ox * (y / oy);
    if (!(crossing >= 0 && crossing <= frame.length)) return;
    offer(frame.apex, {sigma + std::sqrt(ox * ox + oy * oy), sigma, ox, oy, h, k_none, a.source, root});
  }

  const ExactSurface& surface_;
  const GuessExtent extent_;
  BlockQueue<Due> queue_;
  std::vector<GuessedArrival> arrivals_;
  Index reached_ = 0;  ///< vertices
};

}  // namespace

std::vector<GuessedArrival> guessed_arrivals(const ExactSurface& surface, const SurfacePoints& sources,
                                             const GuessExtent& extent, const JobStage& stage) {
  Guess guess(surface, extent);
  guess.start(sources);
  return guess.run(stage);
}

}  // namespace saddleback
