#include "cell_table.hpp"

#include "draw/colors.hpp"
#include "text.hpp"

#include <frontlux/file.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

namespace frontlux::app {

void write_csv(const std::filesystem::path& file, const Lattice& lattice,
               std::span<const planner::RenderedCell> cells) {
  std::string out = "key_x,key_y,key_z,x,y,z,distance,gain,standard_error,quality,hits,yaw\n";
  for (const planner::RenderedCell& cell : cells) {
    for (const std::uint16_t k : {cell.cell.x, cell.cell.y, cell.cell.z}) out += std::to_string(k) + ',';
    for (const double metres : lattice.exact_center(cell.cell)) out += rounded(metres) + ',';
    for (const double number : {cell.distance, cell.gain, cell.standard_error, cell.quality})
      out += to_text(number) + ',';
    out += std::to_string(cell.hits) + ',' + to_text(cell.yaw) + '\n';
  }
  write_file(file, out);
}

void write_ply(const std::filesystem::path& file, const Lattice& lattice,
               std::span<const planner::RenderedCell> cells) {
  std::string out =
      "ply\nformat binary_little_endian 1.0\ncomment frontlux view quality: metres, z up\nelement vertex " +
      std::to_string(cells.size()) + '\n';
  for (const char* name : {"x", "y", "z", "distance", "gain", "standard_error", "quality", "yaw"})
    out += std::string("property float ") + name + '\n';
  out += "property uint hits\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  double best = 0.0;
  for (const planner::RenderedCell& cell : cells) best = std::max(best, cell.quality);
  for (const planner::RenderedCell& cell : cells) {
    for (const double number :
         {lattice.center(cell.cell.x), lattice.center(cell.cell.y), lattice.center(cell.cell.z),
          cell.distance, cell.gain, cell.standard_error, cell.quality, cell.yaw})
      append_number(out, std::bit_cast<std::uint32_t>(static_cast<float>(number)));
    append_number(out, cell.hits);
    const Color color = color_of(best > 0.0 ? cell.quality / best : 0.0);
    for (const std::uint8_t part : {color.red, color.green, color.blue})
      out.push_back(static_cast<char>(part));
  }
  write_file(file, out);
}

}  // namespace frontlux::app
