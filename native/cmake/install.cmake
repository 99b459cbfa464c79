# SPDX-License-Identifier: MIT
# The C++ library, its headers, and what find_package(saddleback) reads: cmake --install build --component cpp --prefix ...
# Python packages are made of the component "python" alone.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(_package ${CMAKE_INSTALL_LIBDIR}/cmake/saddleback)

# Whether vectors are aligned to 16 or 32 bytes must not depend on the instructions that others compile for.
target_compile_definitions(saddleback INTERFACE $<INSTALL_INTERFACE:EIGEN_MAX_STATIC_ALIGN_BYTES=16>)
install(TARGETS saddleback EXPORT saddleback ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT cpp)
install(DIRECTORY include/saddleback DESTINATION include COMPONENT cpp)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/licenses/saddleback COMPONENT cpp)
install(DIRECTORY licenses/ DESTINATION ${CMAKE_INSTALL_DATADIR}/licenses/saddleback COMPONENT cpp)  # OpenMesh is a part of it
install(EXPORT saddleback NAMESPACE saddleback:: FILE saddlebackTargets.cmake DESTINATION ${_package} COMPONENT cpp)

configure_package_config_file(cmake/saddlebackConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/saddlebackConfig.cmake
  INSTALL_DESTINATION ${_package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/saddlebackConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/saddlebackConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/saddlebackConfigVersion.cmake
  DESTINATION ${_package} COMPONENT cpp)
