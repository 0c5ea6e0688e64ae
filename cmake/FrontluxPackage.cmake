# `cpack` in the build folder makes one archive and one Debian package of all that is built.
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_PACKAGE_VENDOR "the frontlux authors")
set(CPACK_PACKAGE_CONTACT "the frontlux authors <authors@frontlux.invalid>")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS  # where a shared build has its own libraries
  ${PROJECT_BINARY_DIR}/engine ${PROJECT_BINARY_DIR}/planner ${PROJECT_BINARY_DIR}/planner/io)
# Debian's packages hold the same files.
set(CPACK_DEBIAN_PACKAGE_NAME frontlux-all)
set(CPACK_DEBIAN_PACKAGE_CONFLICTS "frontlux, libfrontlux0, libfrontlux-dev, python3-frontlux")
# For find_package(frontlux); a static library's user links the rest as well.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libeigen3-dev, liboctomap-dev")
if(frontlux_static)
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", libtbb-dev, libembree-dev")
  if(FRONTLUX_BUILD_PLANNER)
    string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", libompl-dev, coinor-libipopt-dev, zlib1g-dev, pkg-config")
  endif()
endif()
include(CPack)
