#pragma once
// Places vertices beside cells in the planes of their sites.

#include <compare>
#include <optional>
#include <unordered_map>
#include <vector>

#include "tessellation/log_map/cell_placer.h"

namespace saddleback {

/// A thread's own, for vertices next to cells that are placed; the ways are listed with CellLogMaps.
///
/// A vertex next to another site's cell is placed from vertices of that cell alone: the last bit of the path leaves the
/// cell, all before lies inside (cells are star-shaped). That holds at the cell's border, not for corners far outside.
class VerticesBeside {
 public:
  /// The maps must outlive it.
  explicit VerticesBeside(CellLogMaps& maps);
  /// Forgets all; to be called before other sites are labeled.
  void forget();
  /// Places as CellPlacer::place does. What is asked for this site next is found faster.
  void place_cell(Index site);
  void fetch_cell(Index site) const { placer_.fetch(site); }
  /// Places from a site that has been placed, near whose cell the node lies. Depends on the node and the site alone:
  /// faces that share an edge get the same bits. False where the node is neither seen straight from the site nor next
  /// to a node of its label.
  bool find(Index site, Index node, SiteVector& vector);

  /// A hash for tables of what is known of a site and a node: those next to each other fall into different slots.
  static std::size_t slot_of(Index site, Index node) {
    return static_cast<std::size_t>(node) + 97 * static_cast<std::size_t>(site);
  }

 private:
  /// A vertex beside a cell is asked for by several faces: the last answers are kept.
  struct Beside {
    Index node = k_none, site = k_none;
    std::uint32_t age = 0;
    bool found = false;
    VertexPlace place;
  };
  /// Answers known of the nodes about the last site: which of those that it sees they are or, below 0, ~ of the answer.
  struct Known {
    std::uint32_t round = 0;
    Index at = 0;
  };
  struct Answer {
    bool found;
    SiteVector vector;
  };
  /// A step of a search back from a node. Of equals the one with the least number is the first.
  struct Step {
    double at_best;  ///< no way over the node is shorter
    double back;     ///< length of the way to it
    Index node;
    auto operator<=>(const Step&) const = default;
  };
  Index find_seen(Index site, Index node) const;
  bool has_shorter_way(Index node, Index site, double straight) const;
  bool place_by_cell(Index node, Index site, VertexPlace& place);
  std::optional<double> shorter_way(Index node, Index site, double than);
  bool place_across(Index node, Index site, bool deep, VertexPlace& place);
  bool place_across_own(Index node, Index site, VertexPlace& place);
  const VertexPlace* end_of_edge(Index node, Index site, bool deep, VertexPlace& place);
  std::optional<double> place_by_arc(Index node, Index site, bool has_direction, VertexPlace& place);
  VertexPlace place_after_seen(Index node, Index site, Index seen);
  bool lies_flat(Index node, Index site, const VertexPlace& place, bool with_seen) const;

  static constexpr std::size_t k_beside = 1024;
  const CellLogMaps& maps_;
  const SiteLabels& labels_;
  const ArcRows& arcs_;
  CellPlacer placer_;
  std::vector<Beside> beside_;
  std::uint32_t age_ = 0;    ///< answers of earlier ones are forgotten
  Index site_ = k_none;      ///< placed last
  std::uint32_t round_ = 0;  ///< counts them
  std::vector<Known> table_;
  std::vector<Answer> answers_;
  std::vector<Step> steps_;                    ///< a heap
  std::unordered_map<Index, double> reached_;  ///< by node, the shortest way back so far
};

}  // namespace saddleback
