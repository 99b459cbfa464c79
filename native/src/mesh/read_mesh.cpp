#include "saddleback/mesh/read_mesh.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "saddleback/error.h"

#include "mesh/read/read_format.h"
#include "mesh/repair/repair_steps.h"
#include "support/files.h"

namespace saddleback {
namespace {

using Reader = void (*)(std::string_view, PolygonSoup&);

std::string extension_of(const std::string& path) {
  const std::size_t dot = path.find_last_of("./\\");
  if (dot == path.npos || path[dot] != '.') return {};
  std::string extension = path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; });
  return extension;
}

Reader reader_for(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == "obj") return read_obj;
  if (extension == "off") return read_off;
  if (extension == "ply") return read_ply;
  if (extension == "stl") return read_stl;
  throw InputError(message("path: ", path, " has the extension \"", extension, "\"; wanted obj, ply, off or stl"));
}

std::string read_file(const std::string& path, const JobStage& stage) {
  const std::filesystem::path name = system_path(path);
  std::error_code unknown;
  if (std::filesystem::is_directory(name, unknown))
    throw InputError(message("path: ", path, " is a folder; give a file"));
  const FileHandle file = open_file(name, "rb");
  if (!file) throw InputError(message("path: ", path, " cannot be opened: ", std::strerror(errno)));
  std::string contents;
  constexpr std::size_t k_block = std::size_t{1} << 20;
  if (const std::uintmax_t size = std::filesystem::file_size(name, unknown); !unknown) contents.reserve(size + k_block);
  for (;;) {
    stage.check();
    const std::size_t old = contents.size();
    contents.resize(old + k_block);
    const std::size_t got = std::fread(contents.data() + old, 1, k_block, file.get());
    contents.resize(old + got);
    if (got == k_block) continue;
    if (std::ferror(file.get())) throw InputError(message("path: ", path, " cannot be read: ", std::strerror(errno)));
    return contents;
  }
}

// One vertex for all corners at the same place, in the order of their first.
MeshArrays weld(const MeshArrays& soup, const JobStage& stage) {
  std::vector<Vec3> positions;
  std::vector<std::uint8_t> finite;
  for (std::size_t i = 0; i < soup.xyz.size(); i += 3) {
    positions.emplace_back(soup.xyz[i], soup.xyz[i + 1], soup.xyz[i + 2]);
    finite.push_back(positions.back().allFinite());
  }
  const std::vector<Index> cluster = weld_clusters(positions, finite, 0, stage);
  std::vector<Index> number(positions.size());
  MeshArrays result;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (cluster[v] != static_cast<Index>(v)) {
      number[v] = number[cluster[v]];
      continue;
    }
    number[v] = static_cast<Index>(result.xyz.size() / 3);
    result.xyz.insert(result.xyz.end(), positions[v].data(), positions[v].data() + 3);
  }
  for (const Index v : soup.triangles) result.triangles.push_back(number[v]);
  result.warning = soup.warning;
  return result;
}

}  // namespace

MeshArrays parse_arrays(const std::string& path, std::string_view contents, const JobStage& stage) {
  const Reader reader = reader_for(path);
  PolygonSoup soup(stage.part(0, 0.75));
  MeshArrays arrays;
  try {
    reader(contents, soup);
    stage.update(0.75);
    arrays = std::move(soup).triangulate();
  } catch (const MeshError& error) {
    throw MeshError(message(path, ", ", error.what()));
  }
  if (arrays.triangles.empty()) throw MeshError(message(path, " has no faces; give a file with at least one"));
  if (reader == read_stl) arrays = weld(arrays, stage);
  stage.update(1.0);
  return arrays;
}

MeshArrays read_arrays(const std::string& path, Job* job) {
  return read_arrays(path, JobStage(job, "Reading the mesh"));
}

MeshArrays read_arrays(const std::string& path, const JobStage& stage) {
  reader_for(path);  // what cannot be read is not opened
  const std::string contents = read_file(path, stage);
  stage.update(0.2);
  return parse_arrays(path, contents, stage.part(0.2, 1));
}

Mesh read_mesh(const std::string& path, Job* job) {
  const JobStage stage(job, "Reading the mesh");
  const MeshArrays arrays = read_arrays(path, stage.part(0, 0.5));
  return Mesh(arrays.xyz, arrays.triangles, stage.part(0.5, 1));
}

}  // namespace saddleback
