// PLY: a text header that declares elements and their properties, then the elements as text or binary. The vertices'
// x, y, z and the faces' list of vertices are read, whatever their types; all else is passed over.

#include <bit>
#include <cstring>
#include <optional>

#include "saddleback/error.h"

#include "mesh/read_format.h"

namespace saddleback {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Type> type_named(std::string_view name) {
  static constexpr std::pair<std::string_view, Type> k_names[] = {
      {"char", Type::int8},     {"int8", Type::int8},       {"uchar", Type::uint8},    {"uint8", Type::uint8},
      {"short", Type::int16},   {"int16", Type::int16},     {"ushort", Type::uint16},  {"uint16", Type::uint16},
      {"int", Type::int32},     {"int32", Type::int32},     {"uint", Type::uint32},    {"uint32", Type::uint32},
      {"float", Type::float32}, {"float32", Type::float32}, {"double", Type::float64}, {"float64", Type::float64},
  };
  for (const auto& [known, type] : k_names)
    if (known == name) return type;
  return std::nullopt;
}

struct Property {
  std::string_view name;
  Type type;
  std::optional<Type> count_type;  // of a list
};

struct Element {
  std::string_view name;
  std::int64_t count;
  std::vector<Property> properties;
};

enum class Encoding { text, little, big };

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::size_t end = 0;  // where the data begin
};

Type wanted_type(Scanner& scanner) {
  const std::string_view name = scanner.word_in_line();
  const std::optional<Type> type = type_named(name);
  if (!type) scanner.fail(message(quoted(name), " is no PLY type"));
  return *type;
}

Property read_property(Scanner& scanner) {
  Property property;
  const std::string_view first = scanner.word_in_line();
  if (first == "list") {
    property.count_type = wanted_type(scanner);
    property.type = wanted_type(scanner);
  } else if (const std::optional<Type> type = type_named(first)) {
    property.type = *type;
  } else {
    scanner.fail(message(quoted(first), " is no PLY type"));
  }
  property.name = scanner.word_in_line();
  return property;
}

Encoding read_encoding(Scanner& scanner) {
  const std::string_view name = scanner.word_in_line();
  if (name == "ascii") return Encoding::text;
  if (name == "binary_little_endian") return Encoding::little;
  if (name == "binary_big_endian") return Encoding::big;
  scanner.fail(message("unknown PLY format ", quoted(name)));
}

Header read_header(std::string_view text) {
  Scanner scanner(text, 0);
  if (scanner.word() != "ply") scanner.fail("a PLY file begins with ply");
  Header header;
  for (;;) {
    const std::string_view key = scanner.word();
    if (key.empty()) scanner.fail("the header has no end_header");
    if (key == "format") {
      header.encoding = read_encoding(scanner);
    } else if (key == "element") {
      const std::string_view name = scanner.word_in_line();
      const std::int64_t count = scanner.to_integer(scanner.word_in_line(), "an element count");
      if (count < 0) scanner.fail("an element count is negative");
      header.elements.push_back({name, count, {}});
    } else if (key == "property") {
      if (header.elements.empty()) scanner.fail("a property comes before the first element");
      header.elements.back().properties.push_back(read_property(scanner));
    }
    scanner.skip_line();
    if (key == "end_header") break;
  }
  header.end = scanner.position();
  return header;
}

// Values of the two encodings behind one face.
class TextValues {
 public:
  explicit TextValues(std::string_view text) : scanner_(text, 0) {}
  double real(Type) { return scanner_.real("a number"); }
  std::int64_t integer(Type) { return scanner_.integer("a whole number"); }
  [[noreturn]] void fail(const std::string& problem) const { throw MeshError("in the data, " + problem); }

 private:
  Scanner scanner_;
};

class BinaryValues {
 public:
  BinaryValues(std::string_view bytes, std::size_t begin, bool big) : bytes_(bytes), at_(begin), big_(big) {}

  double real(Type type) {
    switch (type) {
      case Type::float32:
        return take<float>();
      case Type::float64:
        return take<double>();
      default:
        return static_cast<double>(integer(type));
    }
  }

  std::int64_t integer(Type type) {
    switch (type) {
      case Type::int8:
        return take<std::int8_t>();
      case Type::uint8:
        return take<std::uint8_t>();
      case Type::int16:
        return take<std::int16_t>();
      case Type::uint16:
        return take<std::uint16_t>();
      case Type::int32:
        return take<std::int32_t>();
      case Type::uint32:
        return take<std::uint32_t>();
      default:
        fail("a count or index is not a whole number");
    }
  }

  [[noreturn]] void fail(const std::string& problem) const { throw MeshError(message("byte ", at_, ": ", problem)); }

 private:
  template <class T>
  T take() {
    if (bytes_.size() - at_ < sizeof(T)) fail("the file ends in the middle of the data");
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if (big_) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }

  std::string_view bytes_;
  std::size_t at_;
  bool big_;
};

// One element after the other.
template <class Values>
class ElementReader {
 public:
  ElementReader(Values values, PolygonSoup& soup) : values_(std::move(values)), soup_(soup) {}

  void read(const Element& element) {
    if (element.properties.empty()) return;  // takes no room, however many there are
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    for (std::int64_t i = 0; i < element.count; ++i) {
      soup_.stage().check();
      std::array<double, 3> xyz{0, 0, 0};
      for (const Property& property : element.properties) {
        if (property.count_type) {
          const bool wanted = is_face && (property.name == "vertex_indices" || property.name == "vertex_index");
          read_list(property, wanted);
        } else {
          const double value = values_.real(property.type);
          if (is_vertex && property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
            xyz[property.name[0] - 'x'] = value;
        }
      }
      if (is_vertex) soup_.add_vertex(xyz[0], xyz[1], xyz[2]);
    }
  }

 private:
  void read_list(const Property& property, bool wanted) {
    const std::int64_t count = values_.integer(*property.count_type);
    if (count < 0) values_.fail("a list has a negative length");
    corners_.clear();
    for (std::int64_t i = 0; i < count; ++i) {
      if (wanted) {
        corners_.push_back(to_index(values_.integer(property.type)));
      } else {
        values_.real(property.type);
      }
    }
    if (wanted) soup_.add_polygon(corners_);
  }

  Values values_;
  PolygonSoup& soup_;
  std::vector<Index> corners_;
};

template <class Values>
void read_elements(const Header& header, Values values, PolygonSoup& soup) {
  ElementReader<Values> reader(std::move(values), soup);
  for (const Element& element : header.elements) reader.read(element);
}

}  // namespace

void read_ply(std::string_view text, PolygonSoup& soup) {
  const Header header = read_header(text);
  if (header.encoding == Encoding::text) {
    read_elements(header, TextValues(text.substr(header.end)), soup);
  } else {
    read_elements(header, BinaryValues(text, header.end, header.encoding == Encoding::big), soup);
  }
}

}  // namespace saddleback
