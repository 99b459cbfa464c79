#include "tessellation/relaxation/cell_cache.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

using PointKey = std::tuple<Index, double, double, double>;

PointKey key_of(const SurfacePoint& point) {
  return {point.face, point.barycentric[0], point.barycentric[1], point.barycentric[2]};
}

/// Returns for each site the number of one that was at the same place before, in increasing order; k_none where there
/// is none.
std::vector<Index> numbers_before(const SurfacePoints& before, const SurfacePoints& now) {
  std::multimap<PointKey, Index> places;
  for (Index i = 0; i < static_cast<Index>(before.size()); ++i) places.emplace(key_of(before[i]), i);
  std::vector<Index> numbers;
  Index next = 0;
  for (const SurfacePoint& site : now) {
    const auto [first, last] = places.equal_range(key_of(site));
    const auto found = std::find_if(first, last, [&](const auto& place) { return place.second >= next; });
    numbers.push_back(found == last ? k_none : found->second);
    if (found != last) next = found->second + 1;
  }
  return numbers;
}

}  // namespace

CellCache::CellCache() : content_(std::make_unique<Content>()) {}
CellCache::~CellCache() = default;

void CellCache::clear() {
  content_->exchange(CachedCells::relaxed, nullptr);
  content_->exchange(CachedCells::shown, nullptr);
}

std::unique_ptr<KnownCells> CellCache::Content::exchange(CachedCells which, std::unique_ptr<KnownCells> cells) {
  const std::scoped_lock lock(mutex_);
  return std::exchange(cells_[static_cast<std::size_t>(which)], std::move(cells));
}

KnownCells::KnownCells(const SaddleVertexGraph& graph, std::span<const double> density, CellLengths lengths,
                       int threads, int cuda_device)
    : graph_(graph),
      density_(density.begin(), density.end()),
      threads_(thread_count(threads)),
      cuda_device_(cuda_device),
      rings_(graph, threads),
      integrals_(std::in_place, graph, rings_, density_, threads),
      candidates_(graph, rings_, lengths, threads, cuda_device) {}

bool KnownCells::fits(const SaddleVertexGraph& graph, int threads, int cuda_device) const {
  return &graph == &graph_ && thread_count(threads) == threads_ && cuda_device == cuda_device_;
}

void KnownCells::change_density(std::span<const double> density) {
  if (std::ranges::equal(density, density_)) return;
  density_.assign(density.begin(), density.end());
  integrals_.emplace(graph_, rings_, density_, threads_);
  moments_.clear();
}

void KnownCells::match(const SurfacePoints& sites) {
  const SurfacePoints& before = candidates_.labels().sites();
  if (!is_whole_) return;
  const std::vector<Index> numbers = numbers_before(before, sites);
  if (2 * std::ranges::count(numbers, k_none) > std::ssize(numbers))
    candidates_.forget();  // others may be far away now
  candidates_.renumber(numbers);
  if (moments_.empty()) return;
  std::vector<CellMoments> moments(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (numbers[i] != k_none) moments[i] = moments_[numbers[i]];
  moments_.swap(moments);
}

const std::vector<CellMoments>& KnownCells::find(const SurfacePoints& sites, const JobStage& stage) {
  if (!std::exchange(is_whole_, false)) candidates_.forget();
  candidates_.find(sites, stage.part(0, 0.8));
  moments_ = integrals_->moments(candidates_, std::move(moments_), stage);
  is_whole_ = true;
  return moments_;
}

void KnownCells::look_farther(const JobStage& stage) {
  is_whole_ = false;
  candidates_.look_farther(stage);
  moments_ = integrals_->moments(candidates_, std::move(moments_), stage);
  is_whole_ = true;
}

BorrowedCells::BorrowedCells(CellCache* cache, CachedCells which, const SaddleVertexGraph& graph,
                             std::span<const double> density, int threads, int cuda_device)
    : cache_(cache), which_(which) {
  if (cache) cells_ = cache->content_->exchange(which, nullptr);
  if (cells_ && cells_->fits(graph, threads, cuda_device))
    cells_->change_density(density);
  else
    cells_ = std::make_unique<KnownCells>(graph, density,
                                          which == CachedCells::relaxed ? CellLengths::smooth : CellLengths::of_ways,
                                          threads, cuda_device);
}

BorrowedCells::~BorrowedCells() {
  if (cache_) cache_->content_->exchange(which_, std::move(cells_));
}

}  // namespace saddleback
