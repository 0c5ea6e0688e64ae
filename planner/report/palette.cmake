# Writes a C++ source with the colours of robots and frontiers: cmake -DINPUT=palette.json -DOUTPUT=<source> -P palette.cmake

cmake_minimum_required(VERSION 3.22)

file(READ ${INPUT} palette)
set(source "#include \"parts.hpp\"\n\nnamespace frontlux::report::detail {\n")
foreach(member IN ITEMS aerial ground)
  string(JSON count LENGTH "${palette}" ${member})
  string(APPEND source "\nstd::span<const ColorPair> ${member}_colors() {\n  static constexpr ColorPair kColors[] = {\n")
  math(EXPR last "${count} - 1")
  foreach(i RANGE ${last})
    string(JSON light GET "${palette}" ${member} ${i} 0)
    string(JSON dark GET "${palette}" ${member} ${i} 1)
    string(APPEND source "      {\"${light}\", \"${dark}\"},\n")
  endforeach()
  string(APPEND source "  };\n  return kColors;\n}\n")
endforeach()
string(JSON light GET "${palette}" frontier 0)
string(JSON dark GET "${palette}" frontier 1)
file(WRITE ${OUTPUT} "${source}\n}  // namespace frontlux::report::detail\n\n"
  "frontlux::report::ColorPair frontlux::report::frontier_color() { return {\"${light}\", \"${dark}\"}; }\n")
