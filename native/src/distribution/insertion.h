#pragma once
// Lays candidates one after the other, as far as others can tell, by several threads.

#include <array>
#include <memory>
#include <vector>

#include "saddleback/distribution/distribution.h"

#include "distribution/placing_rules.h"

namespace saddleback::distribution {

struct Candidate {
  double key;  ///< the smallest comes first; not negative
  Index kind;
  Index cell;  ///< of the caller's
  SurfacePoint center;
  double scale;
  /// Says that the candidate is not to be turned away by what is only foreseen: its outline is tested.
  bool is_thorough = false;
  /// Says that the candidate is as thorough, to learn whether shapes can be laid there at all.
  bool is_probe = false;
  /// A copy that lies there already, as it lies: it is wanted whatever the counts say. Null: a new one.
  const Placement* lying = nullptr;
};

enum class Outcome : std::uint8_t { laid, not_wanted, collision, boundary, forbidden, fold, stretched };

class Insertion {
 public:
  Insertion(const Mesh& mesh, const PlacingRules& rules, const DistributionOptions& options);

  const PlacedShapes& settled() const { return settled_; }
  std::span<const std::int64_t> rejections() const { return rejections_; }

  bool is_wanted(Index shape) const {
    return (wanted_.empty() || inserted_[shape] < wanted_[shape]) && !is_ahead(shape);
  }
  bool is_any_wanted() const;
  /// Tells whether so much was tried in vain on the bare surface that copies, with their gap, find no room at all.
  bool is_hopeless() const;
  /// Returns how often to try it, against others: as many as are missing; all equal where neither counts nor shares are
  /// wanted.
  double share(Index shape) const;

  /// Lays those that find room, in the order of their keys, of equal ones in the order given. Returns what became of
  /// each, in the order given. Stops as soon as every count is met, or nothing can be hoped for. Those tried at a time
  /// come in the order of their faces where that is given: neighbors find the same part of the mesh in the cache. It
  /// changes no result.
  std::vector<Outcome> insert(std::span<const Candidate> candidates, const JobStage& stage,
                              std::span<const std::uint64_t> face_order = {});

  /// Lays copies that lie there already. \throw InputError naming the first that cannot be, or that meets one before
  /// it, unless `are_apart` tells that none does, whatever their gap.
  void keep(std::span<const Placement> lying, bool are_apart, const JobStage& stage);

  /// Tells whether a copy meets one that lies there, as far as can be foreseen.
  bool is_foreseen_to_meet(const Copy& copy) const;

 private:
  struct Attempt {
    Copy copy;
    bool is_lying = false;
    Outcome outcome = Outcome::laid;
    SurfaceOutline outline;
    // If it has room:
    std::vector<LaidVertex> plane;  ///< vertices about the copy
    std::vector<FacePlace> faces;   ///< that it touches
  };
  /// A copy whose surroundings are not known yet.
  struct Pending {
    Index copy;
    std::vector<LaidVertex> plane;
    std::vector<Index> faces;  ///< those that it touches are known
  };

  /// Tells whether another copy would be more than the shape's share.
  bool is_ahead(Index shape) const {
    constexpr double k_slack = 1.01;
    return !shares_.empty() && inserted_[shape] >= k_slack * shares_[shape] * (inserted_in_all_ + 1) + 1;
  }
  void attempt(const Candidate& candidate, Attempt& attempt, int thread) const;
  void map(Attempt& attempt, OutlineMapper& mapper) const;
  void test(Attempt& attempt) const;
  Outcome commit(Attempt& attempt);
  void make_pending_known();

  const Mesh* mesh_;
  const PlacingRules* rules_;
  std::span<const std::uint8_t> forbidden_;
  int threads_;
  PlacedShapes settled_;
  std::vector<Index> wanted_, inserted_;
  std::vector<double> shares_;  ///< sum 1; empty: any
  Index inserted_in_all_ = 0;
  bool are_apart_ = false;  ///< those that lie there already
  std::array<std::int64_t, k_rejection_count> rejections_{};
  double most_in_vain_;                                          ///< candidates on a bare surface
  double most_beyond_;                                           ///< of these, when all reach beyond the boundary
  mutable std::vector<std::unique_ptr<OutlineMapper>> mappers_;  ///< one a thread
  std::vector<Attempt> attempts_;
  mutable std::vector<std::unique_ptr<LocalLayout>> surroundings_;  ///< one a thread
  std::vector<Pending> pending_;
  std::vector<std::uint32_t> touched_;  ///< per face the last batch that laid something there
  std::uint32_t batch_ = 0;
};

}  // namespace saddleback::distribution
