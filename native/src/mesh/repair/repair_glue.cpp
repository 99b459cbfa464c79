// Cutting and stitching [gueziec2001]. Every edge with two half-edges is glued. At an edge with more, those glued in
// the input (the same two vertices, exactly two faces) stay so; the rest are paired by geometry below. Faces are
// oriented breadth first, crossing edges where the input agrees with itself before others, so that a seam that must be
// cut (a Moebius strip) is where the input has it; crowded edges then join oriented patches by union-find with parity.

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <numeric>

#include "mesh/repair/repair_steps.h"
#include "mesh/tables/edge_table.h"

namespace saddleback {
namespace {

Sheets gather(const RepairState& state) {
  Sheets sheets;
  sheets.faces = state.live_faces();
  for (const Index f : sheets.faces) {
    const Triangle& t = state.triangles[f];
    sheets.fine.push_back(t);
    sheets.coarse.push_back({state.cluster[t[0]], state.cluster[t[1]], state.cluster[t[2]]});
  }
  return sheets;
}

bool repeats_vertex(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// True if any face was dropped.
bool drop_repeated(RepairState& state, const Sheets& sheets) {
  bool dropped = false;
  for (std::size_t i = 0; i < sheets.faces.size(); ++i) {
    if (!repeats_vertex(sheets.coarse[i])) continue;
    state.alive[sheets.faces[i]] = 0;
    state.count(repeats_vertex(sheets.fine[i]) ? "faces_repeating_a_vertex" : "faces_without_area");
    dropped = true;
  }
  return dropped;
}

bool drop_duplicates(RepairState& state, const Sheets& sheets, const EdgeTable& edges) {
  bool dropped = false;
  for (Index e = 0; e < edges.edge_count(); ++e) {
    if (edges.edge(e).size() < 2) continue;
    for_each_duplicate(sheets.coarse, edges.edge(e), [&](Index, Index repeat) {
      state.alive[sheets.faces[repeat]] = 0;
      state.count("faces_duplicate");
      dropped = true;
    });
  }
  return dropped;
}

// Sets whose members know their orientation relative to the set's root.
class Patches {
 public:
  explicit Patches(Index count) : parent_(count), turned_(count, 0) { std::iota(parent_.begin(), parent_.end(), 0); }
  struct Place {
    Index root;
    bool turned;
  };
  Place find(Index patch) {
    Index root = patch;
    bool turned = false;
    while (parent_[root] != root) {
      turned ^= turned_[root] != 0;
      root = parent_[root];
    }
    for (bool rest = turned; patch != root;) {  // compress the path
      const Index next = parent_[patch];
      const bool own = turned_[patch] != 0;
      parent_[patch] = root;
      turned_[patch] = rest;
      rest ^= own;
      patch = next;
    }
    return {root, turned};
  }
  // Joins two roots, the later one turned over relative to the earlier or not.
  void join(Index a, Index b, bool turned) {
    parent_[std::max(a, b)] = std::min(a, b);
    turned_[std::max(a, b)] = turned;
  }

 private:
  std::vector<Index> parent_;
  std::vector<std::uint8_t> turned_;
};

class Gluer {
 public:
  Gluer(RepairState& state, Sheets& sheets, const EdgeTable& edges) : state_(state), sheets_(sheets), edges_(edges) {
    sheets_.twins.assign(3 * sheets_.faces.size(), k_none);
    sheets_.turned.assign(sheets_.faces.size(), 0);
  }

  void run(const JobStage& stage) {
    glue_plain_edges();
    stage.check();
    orient(stage);
    cut_seams();
    turn_minorities(patch_, patch_count_);
    stage.check();
    Patches patches(patch_count_);
    for (const std::vector<Index>& crowd : crowds_) pair_crowd(crowd, patches);
    std::vector<Index> labels(sheets_.faces.size());
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const Patches::Place place = patches.find(patch_[i]);
      labels[i] = place.root;
      sheets_.turned[i] ^= place.turned;
    }
    turn_minorities(labels, patch_count_);
    turn_outward(state_, sheets_, labels, patch_count_, stage);
    turn_seen_outward(state_, sheets_, labels, patch_count_, stage);
    state_.count("faces_flipped", static_cast<Index>(std::count(sheets_.turned.begin(), sheets_.turned.end(), 1)));
  }

 private:
  Index from(Index h) const { return halfedge_from(sheets_.coarse, h); }
  Index to(Index h) const { return halfedge_to(sheets_.coarse, h); }
  bool same_direction(Index g, Index h) const { return from(g) == from(h); }
  const Vec3& place(Index vertex) const { return state_.positions[vertex]; }

  void glue(Index g, Index h) {
    sheets_.twins[g] = h;
    sheets_.twins[h] = g;
  }

  std::pair<Index, Index> fine_ends(Index h) const {
    return std::minmax({halfedge_from(sheets_.fine, h), halfedge_to(sheets_.fine, h)});
  }

  // Edges of two half-edges and, at others, the pairs that the input joined; the rest become crowds.
  void glue_plain_edges() {
    for (Index e = 0; e < edges_.edge_count(); ++e) {
      const std::span<const Index> around = edges_.edge(e);
      if (around.size() == 2) glue(around[0], around[1]);
      if (around.size() <= 2) continue;
      std::vector<Index> sorted(around.begin(), around.end()), crowd;
      std::stable_sort(sorted.begin(), sorted.end(), [&](Index g, Index h) { return fine_ends(g) < fine_ends(h); });
      for (std::size_t i = 0, end = 0; i < sorted.size(); i = end) {
        while (end < sorted.size() && fine_ends(sorted[end]) == fine_ends(sorted[i])) ++end;
        if (end - i == 2) {
          glue(sorted[i], sorted[i + 1]);
        } else {
          crowd.insert(crowd.end(), sorted.begin() + static_cast<std::ptrdiff_t>(i),
                       sorted.begin() + static_cast<std::ptrdiff_t>(end));
        }
      }
      if (crowd.size() > 1) {
        std::sort(crowd.begin(), crowd.end());
        state_.count("edges_non_manifold");
        crowds_.push_back(std::move(crowd));
      }
    }
  }

  // Breadth first over glued edges, the ones where the input is consistent first.
  void orient(const JobStage& stage) {
    struct Step {
      Index face;
      bool turned;
    };
    patch_.assign(sheets_.faces.size(), k_none);
    std::deque<Step> front;
    for (Index seed = 0; seed < static_cast<Index>(patch_.size()); ++seed) {
      if (patch_[seed] != k_none) continue;
      front.push_back({seed, false});
      while (!front.empty()) {
        stage.check();
        const Step step = front.front();
        front.pop_front();
        if (patch_[step.face] != k_none) continue;
        patch_[step.face] = patch_count_;
        sheets_.turned[step.face] = step.turned;
        for (Index h = 3 * step.face; h < 3 * step.face + 3; ++h) {
          const Index twin = sheets_.twins[h];
          if (twin == k_none || patch_[twin / 3] != k_none) continue;
          const bool disagree = same_direction(h, twin);
          if (disagree) {
            front.push_back({twin / 3, !step.turned});
          } else {
            front.push_front({twin / 3, step.turned});
          }
        }
      }
      ++patch_count_;
    }
  }

  void cut_seams() {
    for (Index h = 0; h < static_cast<Index>(sheets_.twins.size()); ++h) {
      const Index twin = sheets_.twins[h];
      if (twin < h) continue;
      const bool turned = sheets_.turned[h / 3] != sheets_.turned[twin / 3];
      if (turned == same_direction(h, twin)) continue;
      sheets_.twins[h] = sheets_.twins[twin] = k_none;
      state_.count("edges_cut");
    }
  }

  // Keeps the orientation that most faces of a label came with.
  void turn_minorities(const std::vector<Index>& labels, Index label_count) {
    std::vector<Index> balance(label_count, 0);
    for (std::size_t i = 0; i < labels.size(); ++i) balance[labels[i]] += sheets_.turned[i] ? 1 : -1;
    for (std::size_t i = 0; i < labels.size(); ++i) sheets_.turned[i] ^= balance[labels[i]] > 0;
  }

  bool runs_up(Index h) const { return (from(h) < to(h)) != (sheets_.turned[h / 3] != 0); }

  // Half-edges about one edge, by the angle of their faces; runs_up tells which way the face's own orientation goes.
  struct Wing {
    double angle;
    Index halfedge;
    bool up;
  };

  std::vector<Wing> wings_of(const std::vector<Index>& crowd) const {
    const Index a = std::min(from(crowd[0]), to(crowd[0])), b = std::max(from(crowd[0]), to(crowd[0]));
    const Vec3 axis = (place(b) - place(a)).normalized();
    const Vec3 x = axis.unitOrthogonal(), y = axis.cross(x);
    std::vector<Wing> wings;
    for (const Index h : crowd) {
      const Vec3 wing = place(halfedge_apex(sheets_.coarse, h)) - place(a);
      wings.push_back({std::atan2(wing.dot(y), wing.dot(x)), h, runs_up(h)});
    }
    std::sort(wings.begin(), wings.end(), [](const Wing& v, const Wing& w) {
      return v.angle != w.angle ? v.angle < w.angle : v.halfedge < w.halfedge;
    });
    return wings;
  }

  // Glues two half-edges if some turning of their patches lets them run in opposite directions.
  bool try_pair(const Wing& v, const Wing& w, Patches& patches) {
    const Patches::Place p = patches.find(patch_[v.halfedge / 3]), q = patches.find(patch_[w.halfedge / 3]);
    const bool agree = (v.up != p.turned) != (w.up != q.turned);
    if (p.root == q.root && !agree) return false;
    if (p.root != q.root) patches.join(p.root, q.root, !agree);
    glue(v.halfedge, w.halfedge);
    return true;
  }

  // Where directions alternate all around, the faces bound solids: each pair encloses one. Elsewhere sheets go on as
  // flat as they can; in a crowd too large to try all pairs, neighbors by angle are joined.
  void pair_crowd(const std::vector<Index>& crowd, Patches& patches) {
    std::vector<Wing> wings = wings_of(crowd);
    bool alternate = wings.size() % 2 == 0;
    for (std::size_t i = 0; i < wings.size(); ++i)
      alternate = alternate && wings[i].up != wings[(i + 1) % wings.size()].up;
    if (alternate) {
      // A face running up has its inside clockwise, towards smaller angles.
      for (std::size_t i = 0; i < wings.size(); ++i)
        if (wings[i].up) try_pair(wings[i], wings[(i + wings.size() - 1) % wings.size()], patches);
    } else if (wings.size() > k_all_pairs) {
      std::vector<Wing> open;
      for (const Wing& wing : wings) {
        if (!open.empty() && try_pair(open.back(), wing, patches)) {
          open.pop_back();
        } else {
          open.push_back(wing);
        }
      }
    }
    std::erase_if(wings, [&](const Wing& wing) { return sheets_.twins[wing.halfedge] != k_none; });
    if (wings.size() <= k_all_pairs) pair_flattest(wings, patches);
  }

  void pair_flattest(const std::vector<Wing>& wings, Patches& patches) {
    struct Pair {
      double bend;
      std::size_t i, j;
    };
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < wings.size(); ++i)
      for (std::size_t j = i + 1; j < wings.size(); ++j)
        pairs.push_back({std::abs(std::numbers::pi - std::abs(wings[j].angle - wings[i].angle)), i, j});
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) { return p.bend < q.bend; });
    for (const Pair& pair : pairs) {
      const Wing &v = wings[pair.i], &w = wings[pair.j];
      if (sheets_.twins[v.halfedge] == k_none && sheets_.twins[w.halfedge] == k_none) try_pair(v, w, patches);
    }
  }

  static constexpr std::size_t k_all_pairs = 32;  // 496 pairs: still quick at every edge of a mesh
  RepairState& state_;
  Sheets& sheets_;
  const EdgeTable& edges_;
  std::vector<std::vector<Index>> crowds_;
  std::vector<Index> patch_;
  Index patch_count_ = 0;
};

}  // namespace

Sheets glue_sheets(RepairState& state, const JobStage& stage) {
  Sheets sheets = gather(state);
  if (drop_repeated(state, sheets)) sheets = gather(state);
  stage.update(0.1);
  EdgeTable edges = build_edge_table(sheets.coarse, state.vertex_count(), stage);
  stage.update(0.4);
  if (drop_duplicates(state, sheets, edges)) {
    sheets = gather(state);
    edges = build_edge_table(sheets.coarse, state.vertex_count(), stage);
  }
  stage.update(0.6);
  Gluer(state, sheets, edges).run(stage);
  stage.update(1.0);
  return sheets;
}

}  // namespace saddleback
