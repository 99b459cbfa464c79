# SPDX-License-Identifier: MIT
# Eigen 3.4: the system's, or else the headers that PyPI carries.
find_package(Eigen3 3.4 QUIET NO_MODULE)
if(NOT Eigen3_FOUND)
  fetch_from_pypi(cmeel-eigen==3.4.0.2 cmeel_eigen-3.4.0.2-0-py3-none-any.whl
    2c3efe70560aca10b9d5b9bac6c883057d30aa08fc7b8cb43f4837e935b214e4 cmeel.prefix)
  find_package(Eigen3 3.4 REQUIRED NO_MODULE PATHS ${SADDLEBACK_DEPS}/cmeel.prefix NO_DEFAULT_PATH)
endif()
