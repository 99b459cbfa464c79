#pragma once
// The memory of waves: columns of equal length that grow, with room for vectors behind their end.

#include <array>
#include <vector>

#include "geodesics/graph/window_batches.h"

namespace saddleback {

/// New entries are zero, so that indices read past the end are valid.
template <int Reals, int Floats, int Ints>
class WindowBatchColumns {
 public:
  /// Room for `count` rows and the padding; keeps what is there. Pointers into the columns end here.
  void reserve(int count) {
    if (count + k_row_padding <= room_) return;
    room_ = 2 * (count + k_row_padding);
    const auto grow = [&](auto& columns) {
      for (auto& column : columns) column.resize(static_cast<std::size_t>(room_));
    };
    grow(reals_);
    grow(floats_);
    grow(ints_);
  }

  /// Copies a row over another.
  void move(int from, int to) {
    const auto copy = [&](auto& columns) {
      for (auto& column : columns) column[static_cast<std::size_t>(to)] = column[static_cast<std::size_t>(from)];
    };
    copy(reals_);
    copy(floats_);
    copy(ints_);
  }

 protected:
  double* real(int column) { return reals_[column].data(); }
  float* single(int column) { return floats_[column].data(); }
  std::int32_t* integer(int column) { return ints_[column].data(); }

 private:
  int room_ = 0;
  std::array<std::vector<double>, Reals> reals_;
  std::array<std::vector<float>, Floats> floats_;
  std::array<std::vector<std::int32_t>, Ints> ints_;
};

class WindowColumns : public WindowBatchColumns<4, 11, 4> {
 public:
  WindowRows rows() {
    return {.from_x = real(0),
            .from_y = real(1),
            .to_x = real(2),
            .to_y = real(3),
            .right_x = single(0),
            .right_y = single(1),
            .left_x = single(2),
            .left_y = single(3),
            .right_reach = single(4),
            .left_reach = single(5),
            .right_way = single(6),
            .left_way = single(7),
            .right_served = single(8),
            .left_served = single(9),
            .most = single(10),
            .edge = integer(0),
            .from = integer(1),
            .to = integer(2),
            .root = integer(3)};
  }
};

class ApexColumns : public WindowBatchColumns<2, 4, 4> {
 public:
  /// Returns the rows from row `first` on.
  ApexRows rows(int first) {
    return {.x = real(0) + first,
            .y = real(1) + first,
            .way = single(0) + first,
            .reach = single(1) + first,
            .from_right = single(2) + first,
            .to_left = single(3) + first,
            .left = integer(0) + first,
            .right = integer(1) + first,
            .slot = integer(2) + first,
            .clearances = integer(3) + first};
  }
};

class SightingColumns : public WindowBatchColumns<4, 2, 4> {
 public:
  /// Returns rows with the places of half-edges or without.
  SightingRows rows(bool with_edges) {
    return {.x = real(0),
            .y = real(1),
            .back_x = single(0),
            .back_y = single(1),
            .from_x = with_edges ? real(2) : nullptr,
            .from_y = with_edges ? real(3) : nullptr,
            .slot = integer(0),
            .label = integer(1),
            .edge = integer(2),
            .root = integer(3)};
  }
};

}  // namespace saddleback
