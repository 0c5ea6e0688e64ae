#pragma once

#include "support/folder_test.hpp"

#include <string>

namespace frontlux::test {

/// docs/robots.md has this row of a table: what was measured is what is documented.
inline void expect_row_in_robots_page(const std::string& row) {
  static const std::string page = content_of(FRONTLUX_DATA_DIR "/../docs/robots.md");
  EXPECT_NE(page.find("\n" + row + "\n"), std::string::npos) << "docs/robots.md lacks\n" << row;
}

}  // namespace frontlux::test
