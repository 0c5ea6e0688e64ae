#include "octomap/octree_file.hpp"

#include <frontlux/file.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace frontlux::detail {
namespace {

constexpr std::string_view kBinaryFirstLine = "# Octomap OcTree binary file";
constexpr std::string_view kFullFirstLine = "# Octomap OcTree file";
constexpr std::string_view kLegacyStart{"\x03\0\0\0", 4};
constexpr std::size_t kTreeDepth = 16;
constexpr const char* kAskForAnotherCopy = "the file is damaged or incomplete: get another copy of it";
constexpr const char* kCheckHeader =
    "the header must hold one line each of 'id', 'size' and 'res', and then 'data'";

[[noreturn]] void fail_at(const std::filesystem::path& file, std::size_t byte, const std::string& what,
                          const std::string& advice) {
  fail(file, what + " (byte " + std::to_string(byte) + ")", advice);
}

OctreeFormat format_of(const std::filesystem::path& file, std::string_view bytes) {
  if (bytes.starts_with(kBinaryFirstLine)) return OctreeFormat::kBinary;
  if (bytes.starts_with(kFullFirstLine)) return OctreeFormat::kFull;
  if (bytes.starts_with(kLegacyStart))
    fail_at(file, 0, "is in OctoMap's binary format from before version 1.0",
            "convert it with OctoMap's convert_octree");
  fail_at(
      file, 0,
      "does not begin with '" + std::string(kBinaryFirstLine) + "' or '" + std::string(kFullFirstLine) + "'",
      "give a .bt or .ot file written by OctoMap");
}

constexpr std::string_view kBlanks = " \t\v\f\r";

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

struct Header {
  std::string tree_type;
  double resolution = 0.0;
  std::uint32_t declared_nodes = 0;
  std::size_t data_offset = 0;
};

// Stricter than OctoMap, which skips lines that it does not know and reads on past a number that it cannot
// read.
Header read_header(const std::filesystem::path& file, std::string_view bytes) {
  struct Field {
    std::string_view name;
    std::optional<std::string_view> value;
    std::size_t offset = 0;
  };
  std::array<Field, 3> fields{{{"id", {}, 0}, {"size", {}, 0}, {"res", {}, 0}}};
  auto& [id, size, res] = fields;
  Header header;
  for (std::size_t begin = 0;;) {
    const auto newline = bytes.find('\n', begin);
    if (newline == std::string_view::npos)
      fail_at(file, bytes.size(), "ends before the 'data' line that closes the header", kAskForAnotherCopy);
    const std::string_view line = trimmed(bytes.substr(begin, newline - begin));
    const std::size_t line_offset = begin;
    begin = newline + 1;
    if (line.empty() || line.front() == '#') continue;
    const std::string_view name = line.substr(0, line.find_first_of(kBlanks));
    const std::string_view value = trimmed(line.substr(name.size()));
    if (name == "data") {
      if (!value.empty())
        fail_at(file, line_offset, "has " + quote(value) + " behind 'data' in its header", kCheckHeader);
      header.data_offset = begin;
      break;
    }
    const auto field =
        std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
    if (field == fields.end())
      fail_at(file, line_offset, "has an unknown line in its header: " + quote(line), kCheckHeader);
    if (field->value)
      fail_at(file, line_offset, "has a second " + quote(name) + " line in its header", kCheckHeader);
    if (value.empty())
      fail_at(file, line_offset, "has no value for " + quote(name) + " in its header", kCheckHeader);
    field->value = value;
    field->offset = line_offset;
  }
  for (const Field& field : fields)
    if (!field.value)
      fail_at(file, header.data_offset, "has no " + quote(field.name) + " line in its header", kCheckHeader);

  header.tree_type = *id.value == "1" ? "OcTree" : std::string(*id.value);  // as the first versions wrote it
  if (header.tree_type != "OcTree" && header.tree_type != "ColorOcTree")
    fail_at(file, id.offset, "holds a tree of type " + quote(*id.value),
            "only OcTree and ColorOcTree are supported: save the map as one of them");
  const auto nodes = number_from<std::uint32_t>(*size.value);
  if (!nodes)
    fail_at(file, size.offset, "declares 'size' " + quote(*size.value) + " in its header",
            "the number of nodes must be a whole number from 0 to 4294967295");
  header.declared_nodes = *nodes;
  const auto resolution = number_from<double>(*res.value);
  if (!resolution || !(*resolution >= kMinResolution && *resolution <= kMaxResolution))
    fail_at(file, res.offset, "declares 'res' " + quote(*res.value) + " in its header",
            "the edge of a voxel must be a number of metres from 1e-9 to 1e9, with a point for decimals");
  header.resolution = *resolution;
  return header;
}

// What the walk below wants to know of the node at the front of `stream`.
struct NodeRecord {
  int nodes;     // that the record makes known
  int children;  // with a record of their own
};

NodeRecord binary_record(const char* stream) {
  const auto tags = static_cast<std::uint32_t>(static_cast<unsigned char>(stream[0]) |
                                               (static_cast<unsigned char>(stream[1]) << 8));
  constexpr std::uint32_t kLowBits = 0x5555;
  return {std::popcount((tags | (tags >> 1)) & kLowBits), std::popcount(tags & (tags >> 1) & kLowBits)};
}

struct NodeCount {
  std::uint64_t nodes = 0;
  std::uint64_t parents = 0;  // of these, those with children
};

// Walks the records depth first and counts the nodes.
class NodeWalk {
 public:
  NodeWalk(const std::filesystem::path& file, std::string_view bytes, const Header& header)
      : file_(file), bytes_(bytes), header_(header), offset_(header.data_offset) {}

  NodeCount binary() {
    NodeCount count{1, 0};
    walk(2, [&](const char* record, std::size_t depth) {
      const auto [made, children] = binary_record(record);
      if (made == 0 && depth == 0)
        fail_at(file_, offset_,
                "holds a root without children, of which a .bt cannot say whether it is free or occupied",
                "save the map as an .ot file");
      if (made == 0)
        fail_at(file_, offset_, "holds a node that claims children and has none", kAskForAnotherCopy);
      if (children != 0 && depth + 1 == kTreeDepth) too_deep();
      count.nodes += static_cast<std::uint64_t>(made);
      ++count.parents;
      return children;
    });
    return count;
  }

  NodeCount full(std::size_t payload) {
    NodeCount count;
    walk(payload + 1, [&](const char* record, std::size_t depth) {
      const int children = std::popcount(static_cast<unsigned char>(record[payload]));
      if (children != 0 && depth == kTreeDepth) too_deep();
      ++count.nodes;
      if (children != 0) ++count.parents;
      return children;
    });
    return count;
  }

  [[nodiscard]] std::size_t end() const { return offset_; }

 private:
  // Calls visit(record, depth), which returns how many records follow as children of this one.
  template <class Visit>
  void walk(std::size_t record_bytes, const Visit& visit) {
    std::array<int, kTreeDepth + 1> pending{1};
    for (std::size_t depth = 0, records = 0;;) {
      if (pending[depth] == 0) {
        if (depth == 0) return;
        --depth;
        continue;
      }
      --pending[depth];
      if (bytes_.size() - offset_ < record_bytes)
        fail_at(file_, bytes_.size(),
                "ends inside the tree, after " + std::to_string(bytes_.size() - header_.data_offset) +
                    " bytes of nodes and " + std::to_string(records) + " records, where " +
                    std::to_string(header_.declared_nodes) + " nodes are declared",
                kAskForAnotherCopy);
      const int children = visit(bytes_.data() + offset_, depth);
      offset_ += record_bytes;
      ++records;
      if (children != 0) pending[++depth] = children;
    }
  }

  [[noreturn]] void too_deep() const {
    fail_at(file_, offset_, "holds a tree of more than " + std::to_string(kTreeDepth) + " levels",
            kAskForAnotherCopy);
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  const Header& header_;
  std::size_t offset_;
};

NodeCount checked_node_count(const std::filesystem::path& file, std::string_view bytes, const Header& header,
                             OctreeFormat format) {
  const std::size_t stream_bytes = bytes.size() - header.data_offset;
  if (header.declared_nodes == 0) {
    if (stream_bytes != 0)
      fail_at(file, header.data_offset,
              "declares no nodes, but " + std::to_string(stream_bytes) + " bytes of nodes follow",
              kAskForAnotherCopy);
    return {};
  }
  constexpr std::size_t kLogOddsBytes = 4, kColorBytes = 3;
  NodeWalk walk(file, bytes, header);
  const NodeCount count =
      format == OctreeFormat::kBinary
          ? walk.binary()
          : walk.full(header.tree_type == "OcTree" ? kLogOddsBytes : kLogOddsBytes + kColorBytes);
  // OctoMap refuses such a .bt itself and never looks at the size of an .ot.
  if (count.nodes != header.declared_nodes && (format == OctreeFormat::kBinary || walk.end() != bytes.size()))
    fail_at(file, walk.end(),
            "declares " + std::to_string(header.declared_nodes) + " nodes and holds " +
                std::to_string(count.nodes),
            kAskForAnotherCopy);
  return count;
}

}  // namespace

OctreeFile read_checked_octree_file(const std::filesystem::path& file) {
  return check_octree_bytes(file, read_file(file));
}

OctreeFile check_octree_bytes(const std::filesystem::path& file, std::string bytes) {
  if (bytes.empty()) fail(file, "is empty", kAskForAnotherCopy);
  OctreeFile tree;
  tree.format = format_of(file, bytes);
  const Header header = read_header(file, bytes);
  const NodeCount count = checked_node_count(file, bytes, header, tree.format);
  tree.node_count = static_cast<std::size_t>(count.nodes);
  tree.parent_count = static_cast<std::size_t>(count.parents);
  tree.tree_type = header.tree_type;
  tree.resolution = header.resolution;
  tree.data_offset = header.data_offset;
  tree.bytes = std::move(bytes);
  return tree;
}

}  // namespace frontlux::detail
