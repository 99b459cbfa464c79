// A graph's file, version 2. Numbers are least significant byte first and aligned; nothing is compressed. The same
// graph gives the same bytes.
//
//   header    112 bytes, see FileHeader, with a CRC-32 of its own
//   vertices  int32 a node: the vertex that it is
//   degrees   uint32 a node: its arcs
//   arcs      uint64 an arc, row after row, as ArcCodec packs them
//   CRC-32    uint32, of all bytes before
//
// A file is believed nothing: its length must be what the header says before memory is taken, its checksum must be
// right before its numbers are looked at, and they must describe a graph that a builder could have made (see
// graph_checks.h). A mapped one is looked at row by row, when a row is read first, and as a whole when asked.
//
// Version 1 had the seconds of the build in the place of the longest path, no longest arc and no CRC-32 of the header.

#include <bit>
#include <cmath>
#include <cstring>

#include "saddleback/error.h"
#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/graph/graph_arcs.h"
#include "geodesics/graph/path_bound.h"
#include "geodesics/graph_checks.h"
#include "geodesics/unfolding/unfolding.h"
#include "support/crc32.h"
#include "support/mapped_file.h"
#include "support/number_files.h"

namespace saddleback {
namespace {

// As in PNG: a byte that is no text, a name, and line ends that a transfer as text would change.
constexpr std::array<char, 8> k_magic{'\x89', 'S', 'V', 'G', 'r', '\r', '\n', '\x1a'};
constexpr std::uint32_t k_version = 2, k_header_bytes = 112, k_header_bytes_before = 96;
constexpr std::uint32_t k_exact_flag = 1;
constexpr const char* k_wrong_checksum = "its checksum is wrong";
constexpr const char* k_wrong_unit = "its lengths are in another unit than this mesh needs";

struct FileHeader {
  std::array<char, 8> magic = k_magic;
  std::uint32_t version = k_version, header_bytes = k_header_bytes;
  std::uint64_t file_bytes = 0;
  std::uint64_t fingerprint = 0, vertex_count = 0, face_count = 0;  // of the mesh
  std::uint64_t arc_count = 0;
  std::uint32_t k = 0, flags = 0;  // how it was built: one of k, accuracy and the flag of exact graphs is not 0
  double accuracy = 0, longest_path = 0;
  double longest_arc = 0;
  std::int32_t target_bits = 0, least_exponent = 0;  // of the codec, as the longest path
  double quantum = 0;

  bool has_lengths() const { return version > 1; }
  CodecParts codec() const { return {target_bits, least_exponent, quantum, longest_path}; }
  std::uint32_t expected_header_bytes() const { return has_lengths() ? k_header_bytes : k_header_bytes_before; }
  /// Returns the bytes of a file with this header: it overflows for no counts of 32 bits and arcs that fit a disk.
  std::uint64_t expected_bytes() const {
    return header_bytes + vertex_count * (sizeof(Index) + sizeof(std::uint32_t)) + arc_count * sizeof(std::uint64_t) +
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
  use(header.longest_path);
  if (header.has_lengths()) use(header.longest_arc);
  use(header.target_bits);
  use(header.least_exponent);
  use(header.quantum);
}

void write_header(NumberFileWriter& file, const FileHeader& header) {
  file.write(std::span<const char>(header.magic));
  file.write(header.version);
  each_field(header, [&](auto field) { file.write(field); });
  file.write(file.crc());
  file.write(std::uint32_t{0});
}

/// Reads and checks the header before anything else of its file is read.
FileHeader read_header(NumberFileReader& file, const std::string& path) {
  FileHeader header;
  header.magic = {};
  if (file.size() >= k_magic.size()) file.read(std::span<char>(header.magic));
  if (header.magic != k_magic)
    throw InputError(message("path: ", path, " is no saddleback graph; give a file that SaddleVertexGraph.save wrote"));
  const auto need = [&](std::uint32_t size) {
    if (file.size() < size) refuse_graph_file(path, message("it is cut off after ", file.size(), " bytes"));
  };
  need(k_header_bytes_before);
  header.version = file.read<std::uint32_t>();
  if (header.version > k_version) {
    throw VersionError(message("path: ", path, " has version ", header.version, " of the graph format, newer than the ",
                               k_version, " that this library reads; update it, or build the graph again"));
  }
  need(header.expected_header_bytes());
  each_field(header, [&](auto& field) { field = file.read<std::remove_reference_t<decltype(field)>>(); });
  if (!header.has_lengths()) return header;
  if (const std::uint32_t crc = file.crc(); file.read<std::uint32_t>() != crc)
    refuse_graph_file(path, "the checksum of its header is wrong");
  if (file.read<std::uint32_t>() != 0) refuse_graph_file(path, "its header has numbers that no version writes");
  return header;
}

void check_size(const FileHeader& header, const NumberFileReader& file, const std::string& path) {
  if (header.version == 0 || header.header_bytes != header.expected_header_bytes()) {
    refuse_graph_file(path, message("its header claims version ", header.version, " with ", header.header_bytes,
                                    " bytes instead of ", header.expected_header_bytes()));
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

void check_codec(const FileHeader& header, const ArcCodec& codec, const std::string& path) {
  if (header.codec() != codec.parts()) refuse_graph_file(path, k_wrong_unit);
}

void check_longest(double claimed, const ArcRows& arcs, const std::string& path) {
  if (const double longest = arcs.find_longest(); claimed != longest)
    refuse_graph_file(path, message("it claims a longest arc of ", claimed, " instead of ", longest));
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
}

/// \throw InputError unless rows of these lengths hold that many arcs.
std::vector<std::int64_t> offsets_of(std::span<const std::uint32_t> degrees, std::uint64_t arc_count,
                                     const std::string& path) {
  std::vector<std::int64_t> offsets(degrees.size() + 1, 0);
  for (std::size_t node = 0; node < degrees.size(); ++node) offsets[node + 1] = offsets[node] + degrees[node];
  if (offsets.back() != static_cast<std::int64_t>(arc_count))
    refuse_graph_file(path, message("its rows hold ", offsets.back(), " arcs instead of ", arc_count));
  return offsets;
}

/// The header of a file that may be a graph of the mesh, by its size.
FileHeader checked_header(NumberFileReader& file, const Mesh& mesh, const std::string& path) {
  FileHeader header = read_header(file, path);
  check_size(header, file, path);
  check_mesh(header, mesh, path);
  return header;
}

/// Copies numbers out of a mapped file.
template <class Number>
std::vector<Number> numbers_at(std::span<const std::byte> bytes, std::uint64_t first, std::uint64_t count) {
  std::vector<Number> numbers(count);
  std::memcpy(numbers.data(), bytes.data() + first, count * sizeof(Number));
  return numbers;
}

}  // namespace

SaddleVertexGraph::SaddleVertexGraph() : kernel_(&wave_kernel(SaddleVertexGraphOptions{}.instructions)) {}

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
  header.longest_path = arcs_->codec().longest();
  header.longest_arc = arcs_->longest();
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
  FileHeader header = checked_header(file, mesh, path);
  SaddleVertexGraph graph;
  graph.mesh_ = &mesh;
  graph.vertices_.resize(header.vertex_count);
  file.read(std::span(graph.vertices_));
  std::vector<std::uint32_t> degrees(header.vertex_count);
  file.read(std::span(degrees));
  ArcWords words(header.arc_count);
  file.read(std::span(words), stage.part(0.02, 0.24));
  if (const std::uint32_t crc = file.crc(); file.read<std::uint32_t>() != crc)
    refuse_graph_file(path, k_wrong_checksum);

  check_build(header, path);
  graph.nodes_ = inverse_order(graph.vertices_, path);
  const ArcCodec codec = graph.codec_of_mesh(stage.part(0.24, 0.35));
  if (!header.has_lengths()) header.longest_path = codec.longest();
  check_codec(header, codec, path);
  graph.arcs_ = std::make_unique<ArcRows>(codec, offsets_of(degrees, words.size(), path), std::move(words));
  check_arcs(mesh, *graph.arcs_, graph.vertices_, path, stage.part(0.38, 0.93));
  if (header.has_lengths()) check_longest(header.longest_arc, *graph.arcs_, path);
  graph.unfolding_ = std::make_unique<Unfolding>(mesh, 0, stage.part(0.93, 1));
  graph.k_ = static_cast<Index>(header.k);
  graph.accuracy_ = header.accuracy;
  graph.exact_ = header.flags == k_exact_flag;
  stage.update(1);
  return graph;
}

SaddleVertexGraph SaddleVertexGraph::open(const std::string& path, const Mesh& mesh, Job* job) {
  NumberFileReader file(path);
  const FileHeader header = checked_header(file, mesh, path);
  if (!header.has_lengths() || std::endian::native == std::endian::big) return load(path, mesh, job);
  const JobStage stage(job, "Opening the graph");
  auto mapped = std::make_shared<MappedRows>(path, header.vertex_count);
  const std::span<const std::byte> bytes = mapped->file.bytes();
  if (bytes.size() != header.file_bytes) refuse_graph_file(path, "it changed while it was opened");
  check_build(header, path);
  SaddleVertexGraph graph;
  graph.mesh_ = &mesh;
  graph.vertices_ = numbers_at<Index>(bytes, k_header_bytes, header.vertex_count);
  graph.nodes_ = inverse_order(graph.vertices_, path);
  stage.check();
  const std::uint64_t degrees_at = k_header_bytes + header.vertex_count * sizeof(Index);
  const std::uint64_t words_at = degrees_at + header.vertex_count * sizeof(std::uint32_t);
  const auto degrees = numbers_at<std::uint32_t>(bytes, degrees_at, header.vertex_count);
  const CodecParts parts = header.codec();
  const bool is_plausible = ArcCodec::bits_of_targets(mesh.vertex_count()) == parts.target_bits && parts.quantum > 0 &&
                            parts.longest > 0 && header.longest_arc <= parts.longest;
  if (!is_plausible) refuse_graph_file(path, k_wrong_unit);
  mapped->words = {reinterpret_cast<const std::uint64_t*>(bytes.data() + words_at), header.arc_count};
  graph.arcs_ = std::make_unique<ArcRows>(ArcCodec(parts), offsets_of(degrees, header.arc_count, path),
                                          std::move(mapped), header.longest_arc);
  graph.k_ = static_cast<Index>(header.k);
  graph.accuracy_ = header.accuracy;
  graph.exact_ = header.flags == k_exact_flag;
  stage.update(1);
  return graph;
}

void SaddleVertexGraph::check_file(Job* job) const {
  const MappedRows* const mapped = arcs_->mapped();
  if (!mapped) return;
  const JobStage stage(job, "Checking the graph"), summing = stage.part(0, 0.5);
  const std::span<const std::byte> bytes = mapped->file.bytes(),
                                   all = bytes.first(bytes.size() - sizeof(std::uint32_t));
  std::uint32_t crc = 0, kept = 0;
  for (std::size_t begin = 0; begin < all.size(); begin += k_file_block) {
    crc = crc32(all.subspan(begin, std::min(k_file_block, all.size() - begin)), crc);
    summing.update(static_cast<double>(begin) / static_cast<double>(all.size()));
  }
  std::memcpy(&kept, bytes.data() + all.size(), sizeof kept);
  if (crc != kept) refuse_graph_file(mapped->path, k_wrong_checksum);
  if (codec_of_mesh(stage.part(0.5, 0.6)).parts() != arcs_->codec().parts())
    refuse_graph_file(mapped->path, k_wrong_unit);
  check_arcs(*mesh_, *arcs_, vertices_, mapped->path, stage.part(0.6, 1));
  check_longest(arcs_->longest(), *arcs_, mapped->path);
  stage.update(1);
}

ArcCodec SaddleVertexGraph::codec_of_mesh(const JobStage& stage) const {
  const PathBounds bounds = path_bounds(*mesh_, nodes_, vertices_, 0, stage);
  return {mesh_->vertex_count(), mesh_->mean_edge_length(), bounds};
}

}  // namespace saddleback
