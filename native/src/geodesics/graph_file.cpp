// A graph's file, version 1. Numbers are least significant byte first; nothing is aligned, nothing is compressed.
//
//   header    96 bytes, see FileHeader
//   vertices  int32 a node: the vertex that it is
//   degrees   uint32 a node: its arcs
//   arcs      uint64 an arc, row after row, as ArcCodec packs them
//   CRC-32    uint32, of all bytes before
//
// A file is believed nothing: its length must be what the header says before memory is taken, its checksum must be
// right before its numbers are looked at, and they must describe a graph that a builder could have made (see
// graph_checks.h).

#include <cmath>

#include "saddleback/error.h"
#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/graph/graph_arcs.h"
#include "geodesics/graph/path_bound.h"
#include "geodesics/graph_checks.h"
#include "geodesics/unfolding/unfolding.h"
#include "support/number_files.h"

namespace saddleback {
namespace {

// As in PNG: a byte that is no text, a name, and line ends that a transfer as text would change.
constexpr std::array<char, 8> k_magic{'\x89', 'S', 'V', 'G', 'r', '\r', '\n', '\x1a'};
constexpr std::uint32_t k_version = 1, k_header_bytes = 96;
constexpr std::uint32_t k_exact_flag = 1;

struct FileHeader {
  std::array<char, 8> magic = k_magic;
  std::uint32_t version = k_version, header_bytes = k_header_bytes;
  std::uint64_t file_bytes = 0;
  std::uint64_t fingerprint = 0, vertex_count = 0, face_count = 0;  // of the mesh
  std::uint64_t arc_count = 0;
  std::uint32_t k = 0, flags = 0;  // how it was built: one of k, accuracy and the flag of exact graphs is not 0
  double accuracy = 0, build_seconds = 0;
  std::int32_t target_bits = 0, least_exponent = 0;  // of the codec
  double quantum = 0;

  /// Returns the bytes of a file with this header: it overflows for no counts of 32 bits and arcs that fit a disk.
  std::uint64_t expected_bytes() const {
    return k_header_bytes + vertex_count * (sizeof(Index) + sizeof(std::uint32_t)) + arc_count * sizeof(std::uint64_t) +
           sizeof(std::uint32_t);
  }
};

/// The fields behind the version in the file's order.
template <class Header, class Use>
void each_field(Header& header, Use&& use) {
  use(header.header_bytes);
  use(header.file_bytes);
  use(header.fingerprint);
  use(header.vertex_count);
  use(header.face_count);
  use(header.arc_count);
  use(header.k);
  use(header.flags);
  use(header.accuracy);
  use(header.build_seconds);
  use(header.target_bits);
  use(header.least_exponent);
  use(header.quantum);
}

void write_header(NumberFileWriter& file, const FileHeader& header) {
  file.write(std::span<const char>(header.magic));
  file.write(header.version);
  each_field(header, [&](auto field) { file.write(field); });
}

/// Reads and checks the header before anything else of its file is read.
FileHeader read_header(NumberFileReader& file, const std::string& path) {
  FileHeader header;
  header.magic = {};
  if (file.size() >= k_magic.size()) file.read(std::span<char>(header.magic));
  if (header.magic != k_magic)
    throw InputError(message("path: ", path, " is no saddleback graph; give a file that SaddleVertexGraph.save wrote"));
  if (file.size() < k_header_bytes) refuse_graph_file(path, message("it is cut off after ", file.size(), " bytes"));
  header.version = file.read<std::uint32_t>();
  if (header.version > k_version) {
    throw VersionError(message("path: ", path, " has version ", header.version, " of the graph format, newer than the ",
                               k_version, " that this library reads; update it, or build the graph again"));
  }
  each_field(header, [&](auto& field) { field = file.read<std::remove_reference_t<decltype(field)>>(); });
  return header;
}

void check_size(const FileHeader& header, const NumberFileReader& file, const std::string& path) {
  if (header.version != k_version || header.header_bytes != k_header_bytes) {
    refuse_graph_file(path, message("its header claims version ", header.version, " with ", header.header_bytes,
                                    " bytes instead of ", k_header_bytes));
  }
  if (file.size() < header.file_bytes)
    refuse_graph_file(path, message("it is cut off after ", file.size(), " of ", header.file_bytes, " bytes"));
  if (file.size() > header.file_bytes) {
    refuse_graph_file(path, message("it goes on for ", file.size() - header.file_bytes, " bytes behind its end of ",
                                    header.file_bytes));
  }
  const bool fits = header.vertex_count <= file.size() && header.arc_count <= file.size();
  if (!fits || header.expected_bytes() != file.size()) {
    refuse_graph_file(path, message("its ", file.size(), " bytes do not hold ", header.vertex_count, " vertices and ",
                                    header.arc_count, " arcs"));
  }
}

void check_mesh(const FileHeader& header, const Mesh& mesh, const std::string& path) {
  const auto vertices = static_cast<std::uint64_t>(mesh.vertex_count());
  const auto faces = static_cast<std::uint64_t>(mesh.face_count());
  if (header.vertex_count != vertices || header.face_count != faces) {
    throw InputError(message("path: ", path, " holds the graph of another mesh (", header.vertex_count,
                             " vertices and ", header.face_count, " faces; this mesh has ", vertices, " and ", faces,
                             "); give that mesh, or build the graph of this one"));
  }
  if (header.fingerprint != mesh.fingerprint()) {
    throw InputError(message("path: ", path,
                             " holds the graph of another mesh (with as many vertices and faces, but "
                             "other positions or triangles); give that mesh, or build the graph of this one"));
  }
}

bool same_codec(const FileHeader& header, const ArcCodec& codec) {
  return header.target_bits == codec.target_bits() && header.least_exponent == codec.least_exponent() &&
         header.quantum == codec.quantum();
}

void check_build(const FileHeader& header, const std::string& path) {
  const bool by_k = header.k > 0 && header.k <= header.vertex_count;
  const bool by_accuracy = header.accuracy > 0 && header.accuracy < 1;
  const bool is_exact = header.flags == k_exact_flag;
  const bool known =
      (header.k == 0 || by_k) && (header.accuracy == 0 || by_accuracy) && (header.flags == 0 || is_exact);
  if (!known || by_k + by_accuracy + is_exact != 1) {
    refuse_graph_file(
        path, message("it claims k = ", header.k, ", accuracy = ", header.accuracy, " and the flags ", header.flags));
  }
  if (!std::isfinite(header.build_seconds) || header.build_seconds < 0)
    refuse_graph_file(path, message("it claims a build of ", header.build_seconds, " seconds"));
}

std::vector<std::int64_t> read_offsets(NumberFileReader& file, std::uint64_t vertex_count) {
  std::vector<std::uint32_t> degrees(vertex_count);
  file.read(std::span(degrees));
  std::vector<std::int64_t> offsets(vertex_count + 1, 0);
  for (std::size_t node = 0; node < degrees.size(); ++node) offsets[node + 1] = offsets[node] + degrees[node];
  return offsets;
}

}  // namespace

SaddleVertexGraph::SaddleVertexGraph() = default;

void SaddleVertexGraph::save(const std::string& path, Job* job) const {
  const JobStage stage(job, "Saving the graph");
  FileHeader header;
  header.fingerprint = mesh_->fingerprint();
  header.vertex_count = static_cast<std::uint64_t>(mesh_->vertex_count());
  header.face_count = static_cast<std::uint64_t>(mesh_->face_count());
  header.arc_count = static_cast<std::uint64_t>(arc_count());
  header.file_bytes = header.expected_bytes();
  header.k = static_cast<std::uint32_t>(k_);
  header.accuracy = accuracy_;
  header.flags = exact_ ? k_exact_flag : 0;
  header.build_seconds = build_seconds_;
  header.target_bits = arcs_->codec().target_bits();
  header.least_exponent = arcs_->codec().least_exponent();
  header.quantum = arcs_->codec().quantum();

  NumberFileWriter file(path);
  write_header(file, header);
  file.write(std::span<const Index>(vertices_), stage.part(0, 0.03));
  std::vector<std::uint32_t> degrees(vertices_.size());
  for (Index node = 0; node < mesh_->vertex_count(); ++node)
    degrees[node] = static_cast<std::uint32_t>(arcs_->first(node + 1) - arcs_->first(node));
  file.write(std::span<const std::uint32_t>(degrees), stage.part(0.03, 0.06));
  file.write(arcs_->words(), stage.part(0.06, 0.95));
  file.write(file.crc());
  stage.update(1);  // the last moment to be cancelled: the old file goes next
  file.commit();
}

SaddleVertexGraph SaddleVertexGraph::load(const std::string& path, const Mesh& mesh, Job* job) {
  const JobStage stage(job, "Loading the graph");
  NumberFileReader file(path);
  const FileHeader header = read_header(file, path);
  check_size(header, file, path);
  check_mesh(header, mesh, path);
  SaddleVertexGraph graph;
  graph.kernel_ = &wave_kernel(SaddleVertexGraphOptions{}.instructions);
  graph.mesh_ = &mesh;
  graph.vertices_.resize(header.vertex_count);
  file.read(std::span(graph.vertices_));
  std::vector<std::int64_t> offsets = read_offsets(file, header.vertex_count);
  ArcWords words(header.arc_count);
  file.read(std::span(words), stage.part(0.02, 0.24));
  if (const std::uint32_t crc = file.crc(); file.read<std::uint32_t>() != crc)
    refuse_graph_file(path, "its checksum is wrong");

  check_build(header, path);
  graph.nodes_ = inverse_order(graph.vertices_, path);
  const PathBounds bounds = path_bounds(mesh, graph.nodes_, graph.vertices_, 0, stage.part(0.24, 0.35));
  const ArcCodec codec(mesh.vertex_count(), mesh.mean_edge_length(), bounds);
  if (!same_codec(header, codec)) refuse_graph_file(path, "its lengths are in another unit than this mesh needs");
  if (offsets.back() != static_cast<std::int64_t>(words.size()))
    refuse_graph_file(path, message("its rows hold ", offsets.back(), " arcs instead of ", words.size()));
  graph.arcs_ = std::make_unique<ArcRows>(codec, std::move(offsets), std::move(words));
  check_arcs(mesh, *graph.arcs_, graph.vertices_, path, stage.part(0.38, 0.93));
  graph.unfolding_ = std::make_unique<Unfolding>(mesh, 0, stage.part(0.93, 1));
  graph.k_ = static_cast<Index>(header.k);
  graph.accuracy_ = header.accuracy;
  graph.exact_ = header.flags == k_exact_flag;
  graph.build_seconds_ = header.build_seconds;
  stage.update(1);
  return graph;
}

}  // namespace saddleback
