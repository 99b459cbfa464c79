// Decisions in the plane on a CUDA device, one by one.

#include "support/cuda/device_buffer.h"
#include "support/cuda/device_launch.cuh"
#include "support/cuda/device_stream.h"
#include "voronoi2d/cuda/device_plane_signs.cuh"
#include "voronoi2d/cuda/device_signs.h"

namespace saddleback {
namespace {

struct Four {
  predicates::Point2 a, b, c, d;
};

__global__ void decide(const Four* fours, std::int32_t count, PlaneSigns* signs) {
  const std::int32_t i = thread_number();
  if (i >= count) return;
  const Four four = fours[i];
  const auto narrow = [](auto sign) { return static_cast<std::int8_t>(sign); };
  bool is_known;
  const int circle = voronoi2d::known_circle_sign(four.a, four.b, four.c, four.d, is_known);
  signs[i] = {narrow(predicates::orient_2d(four.a, four.b, four.c)),
              narrow(predicates::compare_distances(four.a, four.b, four.c)),
              narrow(voronoi2d::turn_sign(four.a, four.b, four.c)),
              narrow(is_known ? circle : voronoi2d::k_unknown_sign),
              narrow(voronoi2d::distance_order(four.a, four.b, four.c))};
}

}  // namespace

CudaStatus plane_signs_on_device(int device, const double* points, std::size_t fours, PlaneSigns* signs,
                                 CudaReason& reason) {
  return cuda_status(reason, [&] {
    if (fours == 0) return;
    check_cuda(cudaSetDevice(device), "choosing the device");
    const Stream stream;
    const DeviceBuffer<Four> there({reinterpret_cast<const Four*>(points), fours}, stream);
    DeviceBuffer<PlaneSigns> found(fours, stream);
    const auto count = static_cast<std::int32_t>(fours);
    decide<<<blocks_for(count), k_threads, 0, stream>>>(there.data(), count, found.data());
    check_cuda(cudaGetLastError(), "deciding");
    found.read({signs, fours});
  });
}

}  // namespace saddleback
