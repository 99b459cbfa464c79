# SPDX-License-Identifier: MIT
# The mesh of OpenMesh's core with its asserts off, as objects that become a part of our library; its readers and writers
# stay out.
#
# Debian's package is a shared library whose asserts abort the process, which inside Blender would cost the artist's
# work. PyPI's source package of the OpenMesh bindings carries the C++ sources.
set(SADDLEBACK_OPENMESH_VERSION 1.2.1)
set(SADDLEBACK_OPENMESH_SOURCE "" CACHE PATH "Folder of the unpacked openmesh source package; empty: fetched with pip")

if(NOT SADDLEBACK_OPENMESH_SOURCE)
  set(SADDLEBACK_OPENMESH_SOURCE ${SADDLEBACK_DEPS}/openmesh-${SADDLEBACK_OPENMESH_VERSION})
  fetch_from_pypi(openmesh==${SADDLEBACK_OPENMESH_VERSION} openmesh-${SADDLEBACK_OPENMESH_VERSION}.tar.gz
    6fd3fa41a68148e4a7523f562426aa9758bf65ccc6642abcf79c37bae9c6af3c openmesh-${SADDLEBACK_OPENMESH_VERSION}
    --no-binary :all:)
elseif(NOT EXISTS ${SADDLEBACK_OPENMESH_SOURCE}/OpenMesh/src)
  message(FATAL_ERROR "SADDLEBACK_OPENMESH_SOURCE=${SADDLEBACK_OPENMESH_SOURCE} holds no OpenMesh/src: "
    "name the unpacked source package, openmesh-${SADDLEBACK_OPENMESH_VERSION}.")
endif()

set(_core ${SADDLEBACK_OPENMESH_SOURCE}/OpenMesh/src/OpenMesh/Core)
add_library(OpenMeshCore OBJECT
  ${_core}/Mesh/ArrayKernel.cc
  ${_core}/Mesh/BaseKernel.cc
  ${_core}/Mesh/PolyConnectivity.cc
  ${_core}/Mesh/TriConnectivity.cc
  ${_core}/System/omstream.cc
  ${_core}/Utils/BaseProperty.cc)
target_include_directories(OpenMeshCore SYSTEM PUBLIC ${SADDLEBACK_OPENMESH_SOURCE}/OpenMesh/src)
target_compile_definitions(OpenMeshCore PUBLIC OM_STATIC_BUILD PRIVATE _USE_MATH_DEFINES NDEBUG)
target_compile_options(OpenMeshCore PRIVATE -w)
