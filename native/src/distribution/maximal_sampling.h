#pragma once
// Looks for room by subdivision, and proves where there is none.

#include <vector>

#include "saddleback/distribution/distribution.h"

#include "distribution/class_densities.h"
#include "distribution/coverage_test.h"
#include "distribution/insertion.h"

namespace saddleback::distribution {

class MaximalSampling {
 public:
  MaximalSampling(const Mesh& mesh, const ClassDensities& densities, const PlacingRules& rules, Insertion& insertion,
                  const DistributionOptions& options);

  /// Lays copies until every count is met, nothing more fits, or (unless all is wanted) rooms become rare.
  DistributionStop run(const JobStage& stage);
  const Certificate& certificate() const { return certificate_; }

 private:
  /// Holds what became of the smallest copy of a kind at some place; collisions and folds stay.
  struct Tried {
    Index kind = k_none;
    Outcome outcome = Outcome::not_wanted;
    bool is(Index what, Outcome is_so) const { return kind == what && outcome == is_so; }
  };
  /// A cell and the kinds that may still fit somewhere in it, by bits.
  struct OpenCell {
    Cell cell;
    std::uint64_t kinds;
    Tried tried = {};  ///< at the cell's center, as a part of another cell
  };
  /// Holds what came of looking at a cell. Plain, as there are many and all threads write theirs first.
  struct Look {
    std::uint64_t open;   ///< kinds that may fit, to be split
    std::uint64_t asked;  ///< kinds of which a copy at the center is to be tried
    Index dart;           ///< a kind to be tried somewhere, or none
    std::int16_t tests, leaves;
    bool is_lost;     ///< some kind cannot be decided
    bool is_central;  ///< the dart is wanted at the center
    bool is_probe;
  };

  void make_base_cells(const JobStage& stage);
  double base_radius() const;
  /// Copies that are wanted by number are looked for where the sample_at_random has missed the room.
  bool searches() const { return options_->maximal || !options_->counts.empty(); }
  void weigh_kinds();
  DistributionStop sample_at_random(const JobStage& stage);
  double weight_at(Index kind, const SurfacePoint& point) const {
    return kind_weights_[kind] * densities_->relative(rules_->kinds()[kind].shape, point);
  }
  template <class Relative>
  double mean_of(Relative&& relative) const;
  double crowding(const SurfacePoint& point) const;
  double most_crowding(Index face) const;
  double mean_drops(Index face, double per_area) const;
  std::uint64_t kinds_in(Index face) const;
  double expected_drops(double per_area) const;
  void try_batch(int number, double per_area, const JobStage& stage);
  template <class Visit>
  void draw_candidates(Index face, int try_batch, double per_area, const JobStage& stage, Visit&& visit) const;
  void order_faces();
  void search_cells(const JobStage& stage);
  void round(const JobStage& stage);
  Look look(const OpenCell& open, CoverageTest::Neighbors& near) const;
  Index draw_kind(std::uint64_t kinds, const SurfacePoint& point, double chance) const;
  double drawn_scale(Index kind, const SurfacePoint& point, double chance) const {
    const double size = rules_->size_at(rules_->kinds()[kind].shape, point);
    return size * (options_->smallest + (options_->largest - options_->smallest) * chance);
  }
  void suspect(Index face);
  void throw_dart(const OpenCell& open, std::uint64_t free, CellView& view, Look& look) const;
  std::uint64_t dart_key(const Cell& cell) const;
  SurfacePoint thrown_point(const Cell& cell) const;
  Candidate central_candidate(Index number, Index kind, std::uint64_t key) const;
  void collect_candidates(Index number, const Look& look, std::vector<Candidate>& candidates) const;
  double order(const SurfacePoint& point, std::uint64_t key) const;
  double tolerance(const CellView& view, const Kind& kind) const {
    const double radius = rules_->smallest_factor() * view.size * rules_->shape_radius(kind);
    return options_->tolerance * (radius + 0.5 * options_->gap);
  }
  double odd_share() const;
  void find_least_stuck();
  void lose(const Cell& cell);

  const Mesh* mesh_;
  const ClassDensities* densities_;
  const PlacingRules* rules_;
  Insertion* insertion_;
  const DistributionOptions* options_;
  CoverageTest coverage_;
  std::vector<OpenCell> open_;
  std::vector<std::uint64_t> face_order_;  ///< keys of their places along a curve
  Index next_face_ = 0;                    ///< whose cells have not been opened yet
  std::vector<double> front_;              ///< per vertex, for packing
  /// Flags of the faces near a place where shapes cannot be laid. Cells there that are small enough to be given up are
  /// probed, as their parts would be one by one.
  std::vector<std::uint8_t> suspected_;
  std::vector<double> kind_weights_;  ///< by which kinds are drawn, where densities are even
  double searched_area_ = 0;          ///< where some kind may be centered
  Certificate certificate_;
  std::int64_t inserted_in_round_ = 0;
  double least_stuck_ = 0;  ///< cells so small are given up where shapes cannot be laid
  int rounds_ = 0;
};

}  // namespace saddleback::distribution
