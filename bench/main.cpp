#include "options.hpp"

#include <exception>
#include <filesystem>
#include <iostream>

int main(int argc, char** argv) {
  try {
    return frontlux::bench::run(argc, argv);
  } catch (const frontlux::bench::Exit& exit) {
    return exit.code;
  } catch (const std::exception& error) {
    std::cerr << std::filesystem::path(argv[0]).filename().string() << ": " << error.what() << '\n';
    return 2;
  }
}
