# Provides Eigen3::Eigen.
#
# The headers of the cmeel-eigen wheel, a build requirement, come before those of the system, so
# that every build compiles the same Eigen. Eigen3_DIR or CMAKE_PREFIX_PATH choose another one.
set(build_requirement "")
if(Python_EXECUTABLE)
  execute_process(
    COMMAND "${Python_EXECUTABLE}" -c "from importlib.metadata import distribution as installed; \
print(installed('cmeel-eigen').locate_file('cmeel.prefix').as_posix())"
    OUTPUT_VARIABLE build_requirement OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()

set(eigen_wheel "")
find_package(Eigen3 3.4 CONFIG QUIET HINTS "${build_requirement}")
if(NOT Eigen3_FOUND)
  fetch_wheel(eigen_wheel "${CMAKE_CURRENT_LIST_DIR}/eigen.txt"
    "Instead, install Eigen 3.4 and set CMAKE_PREFIX_PATH to the folder it is installed in.")
  find_package(Eigen3 3.4 CONFIG REQUIRED NO_DEFAULT_PATH PATHS "${eigen_wheel}/cmeel.prefix")
endif()
message(STATUS "Eigen ${Eigen3_VERSION}: ${Eigen3_DIR}")
if(eigen_wheel)
  unset(Eigen3_DIR CACHE) # look at the machine first next time, too
endif()
