# Writes a C++ source that holds a file: cmake -DINPUT=<file> -DOUTPUT=<source> -P embed.cmake

cmake_minimum_required(VERSION 3.22)

file(READ ${INPUT} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT} "#include \"parts.hpp\"

namespace frontlux::report::detail {
namespace {
constexpr unsigned char kBytes[] = {
${bytes}};
}  // namespace

std::string_view page() { return {reinterpret_cast<const char*>(kBytes), sizeof kBytes}; }

}  // namespace frontlux::report::detail
")
