// PLY: a text header that declares elements and their properties, then the elements as text (a line each) or binary.
// The vertices' x, y, z and the lists of vertices of faces and triangle strips are read, whatever their types and
// whether in small letters or capitals; all else that the header declares is passed over.

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <optional>

#include "saddleback/error.h"

#include "mesh/read/read_format.h"

namespace saddleback {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

bool is_whole(Type type) { return type != Type::float32 && type != Type::float64; }

std::optional<Type> type_named(std::string_view word) {
  const std::string name = lower_case(word);
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

enum class Role { none, x, y, z, corners };

struct Property {
  std::string name;  ///< in small letters
  Type type;
  std::optional<Type> count_type;  ///< of a list
  Role role = Role::none;          ///< what is read
};

struct Element {
  std::string name;  ///< in small letters
  std::int64_t count;
  Index line;  ///< where the header declares it
  std::vector<Property> properties;
};

enum class Encoding { text, little, big };

struct Header {
  std::optional<Encoding> encoding;
  std::vector<Element> elements;
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
  if (lower_case(first) == "list") {
    property.count_type = wanted_type(scanner);
    if (!is_whole(*property.count_type)) scanner.fail("the length of a list is not a whole number");
    property.type = wanted_type(scanner);
  } else if (const std::optional<Type> type = type_named(first)) {
    property.type = *type;
  } else {
    scanner.fail(message(quoted(first), " is no PLY type"));
  }
  property.name = lower_case(scanner.word_in_line());
  if (property.name.empty()) scanner.fail("a property has no name");
  return property;
}

Encoding read_encoding(Scanner& scanner) {
  const std::string_view name = scanner.word_in_line();
  if (name == "ascii") return Encoding::text;
  if (name == "binary_little_endian") return Encoding::little;
  if (name == "binary_big_endian") return Encoding::big;
  scanner.fail(message("unknown PLY format ", quoted(name)));
}

Element read_element(Scanner& scanner, const Header& header) {
  const std::string name = lower_case(scanner.word_in_line());
  for (const Element& other : header.elements)
    if (other.name == name) scanner.fail(message("a second element is called ", quoted(name)));
  return {name, scanner.to_count(scanner.word_in_line(), "an element count"), scanner.line(), {}};
}

Property* find_property(Element& element, std::string_view name, bool is_list) {
  Property* found = nullptr;
  for (Property& property : element.properties) {
    if (property.name != name) continue;
    if (found) Scanner::fail_at(element.line, message(element.name, " has two properties ", name));
    found = &property;
  }
  if (found && found->count_type.has_value() != is_list)
    Scanner::fail_at(element.line, message(element.name, "'s property ", name, is_list ? " is no list" : " is a list"));
  return found;
}

// Tells the properties that are read what they are; refuses an element that lacks them.
void give_roles(Element& element) {
  if (element.count == 0) return;
  if (element.name == "vertex") {
    for (const auto& [name, role] : {std::pair("x", Role::x), std::pair("y", Role::y), std::pair("z", Role::z)}) {
      Property* const property = find_property(element, name, false);
      if (!property) Scanner::fail_at(element.line, message("the vertices have no property ", name));
      property->role = role;
    }
  } else if (element.name == "face" || element.name == "tristrips") {
    Property* property = find_property(element, "vertex_indices", true);
    if (!property) property = find_property(element, "vertex_index", true);
    if (!property) Scanner::fail_at(element.line, message(element.name, " has no property vertex_indices"));
    if (!is_whole(property->type)) Scanner::fail_at(element.line, "vertex_indices are no whole numbers");
    property->role = Role::corners;
  }
}

// Leaves the scanner where the data begin.
Header read_header(Scanner& scanner) {
  if (lower_case(scanner.word()) != "ply") scanner.fail("a PLY file begins with ply");
  scanner.skip_line();
  Header header;
  for (;;) {
    const std::string_view word = scanner.word();
    const std::string key = lower_case(word);
    if (key.empty()) scanner.fail("the header has no end_header");
    if (key == "format") {
      header.encoding = read_encoding(scanner);
    } else if (key == "element") {
      header.elements.push_back(read_element(scanner, header));
    } else if (key == "property") {
      if (header.elements.empty()) scanner.fail("a property comes before the first element");
      header.elements.back().properties.push_back(read_property(scanner));
    } else if (key != "comment" && key != "obj_info" && key != "end_header") {
      scanner.fail(message(quoted(word), " is no keyword of a PLY header"));
    }
    scanner.skip_line();
    if (key == "end_header") break;
  }
  if (!header.encoding) scanner.fail("the header does not tell the format");
  for (Element& element : header.elements) give_roles(element);
  return header;
}

// Values of the two encodings behind one face.
class TextValues {
 public:
  explicit TextValues(const Scanner& scanner) : scanner_(scanner) {}
  double real(Type) { return scanner_.real("a number"); }
  std::int64_t integer(Type) { return scanner_.integer("a whole number"); }
  void end_element() {
    if (!scanner_.word_in_line().empty()) fail("the line holds more than the header declares");
  }
  void end_file() {
    if (!scanner_.word().empty()) fail("the file goes on behind the last element");
  }
  [[noreturn]] void fail(const std::string& problem) const { scanner_.fail(problem); }

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

  void end_element() {}
  // Some editors and transfers add line ends, or fill up a block.
  void end_file() {
    const auto is_filling = [](char c) { return c == '\0' || c == '\n' || c == '\r' || c == ' '; };
    const std::string_view rest = bytes_.substr(at_);
    if (!std::all_of(rest.begin(), rest.end(), is_filling)) fail("the file goes on behind the last element");
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
  ElementReader(Values values, const Header& header, PolygonSoup& soup)
      : values_(std::move(values)), header_(header), soup_(soup) {}

  void read() {
    for (const Element& element : header_.elements)
      if (element.name == "vertex") vertex_count_ = element.count;
    for (const Element& element : header_.elements) read_element(element);
    values_.end_file();
  }

 private:
  void read_element(const Element& element) {
    if (element.properties.empty()) return;  // takes no room, however many there are
    const bool is_vertex = element.name == "vertex";
    is_strip_ = element.name == "tristrips";
    for (std::int64_t i = 0; i < element.count; ++i) {
      soup_.stage().check();
      std::array<double, 3> xyz{};
      for (const Property& property : element.properties) {
        if (property.count_type) {
          read_list(property);
          continue;
        }
        const double value = values_.real(property.type);
        if (property.role != Role::none) xyz[static_cast<int>(property.role) - static_cast<int>(Role::x)] = value;
      }
      values_.end_element();
      if (is_vertex) soup_.add_vertex(xyz[0], xyz[1], xyz[2]);
    }
  }

  void read_list(const Property& property) {
    const std::int64_t count = values_.integer(*property.count_type);
    if (count < 0) values_.fail("a list has a negative length");
    if (property.role == Role::none) {
      for (std::int64_t i = 0; i < count; ++i) values_.real(property.type);
      return;
    }
    corners_.clear();
    for (std::int64_t i = 0; i < count; ++i) corners_.push_back(vertex(values_.integer(property.type)));
    if (is_strip_) {
      add_strips();
    } else {
      soup_.add_polygon(corners_);
    }
  }

  // In strips -1 stands between two.
  Index vertex(std::int64_t number) const {
    if (number < (is_strip_ ? -1 : 0) || number >= vertex_count_ || number > std::numeric_limits<Index>::max())
      values_.fail(no_such_vertex(number, vertex_count_));
    return static_cast<Index>(number);
  }

  // Each corner closes a triangle with the two before it, turned over every second time.
  void add_strips() {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (corners_[i] == k_none) begin = i + 1;
      if (i < begin + 2) continue;
      const bool turned = (i - begin) % 2 == 1;
      const Index a = corners_[i - 2], b = corners_[i - 1], c = corners_[i];
      if (a != b && b != c && c != a) soup_.add_polygon(std::array{turned ? b : a, turned ? a : b, c});
    }
  }

  Values values_;
  const Header& header_;
  PolygonSoup& soup_;
  std::int64_t vertex_count_ = 0;
  bool is_strip_ = false;
  std::vector<Index> corners_;
};

// Where each line ends with \r alone, a first byte of \n belongs to the data.
std::size_t data_begin(std::string_view text, const Scanner& scanner) {
  const std::size_t at = scanner.position(), first = text.find_first_of("\r\n");
  const bool lone = first != text.npos && text[first] == '\r' && first + 1 < text.size() && text[first + 1] != '\n';
  return lone && text.substr(at - 2, 2) == "\r\n" ? at - 1 : at;
}

}  // namespace

void read_ply(std::string_view text, PolygonSoup& soup) {
  Scanner scanner(text, 0);
  const Header header = read_header(scanner);
  if (header.encoding == Encoding::text) {
    ElementReader(TextValues(scanner), header, soup).read();
  } else {
    ElementReader(BinaryValues(text, data_begin(text, scanner), header.encoding == Encoding::big), header, soup).read();
  }
}

}  // namespace saddleback
