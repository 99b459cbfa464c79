// SPDX-License-Identifier: MIT
// Coverage-guided fuzzing of the mesh readers: tests/sanitize --fuzz readers [SECONDS].
// The first byte of an input chooses the format, the rest is the file.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "saddleback/error.h"
#include "saddleback/mesh/read_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* k_names[] = {"a.obj", "a.off", "a.ply", "a.stl"};
  if (size == 0) return 0;
  const std::string_view contents(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    const saddleback::MeshArrays arrays = saddleback::parse_arrays(k_names[data[0] % 4], contents);
    const std::size_t vertices = arrays.xyz.size() / 3;
    for (const saddleback::Index v : arrays.triangles)
      if (v < 0 || static_cast<std::size_t>(v) >= vertices) std::abort();
  } catch (const saddleback::Error& error) {
    if (std::string_view(error.what()).substr(0, 2) != "a.") std::abort();  // every sentence names the file
  }
  return 0;
}
