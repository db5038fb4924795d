# Provides manutec_r3_sundials: the integrators ERKStep (of ARKODE) and BDF (of CVODES or CVODE).
#
# A SUNDIALS that the machine has is preferred. Otherwise the official Python wheel serves: it
# carries headers, static libraries and a CMake package. Version 7.1 brought the functions that
# all steppers of ARKODE share.
include(CheckSymbolExists)

set(components core arkode nvecserial sunmatrixdense sunlinsoldense)

macro(find_sundials)
  # The suffixes are where the wheel has its package; CMake does not search lib64 everywhere.
  find_package(SUNDIALS 7.1...<8 CONFIG COMPONENTS ${components} OPTIONAL_COMPONENTS cvodes cvode
               PATH_SUFFIXES lib64/cmake/sundials lib/cmake/sundials ${ARGN})
endmacro()

set(sundials_wheel "")
find_sundials(QUIET)
if(NOT SUNDIALS_FOUND)
  fetch_wheel(sundials_wheel "${CMAKE_CURRENT_LIST_DIR}/sundials.txt"
    "Instead, install SUNDIALS 7.1 or later with ARKODE and CVODES, and set CMAKE_PREFIX_PATH to \
the folder it is installed in or SUNDIALS_DIR to the folder of its SUNDIALSConfig.cmake.")
  find_sundials(REQUIRED NO_DEFAULT_PATH PATHS "${sundials_wheel}")
endif()
message(STATUS "SUNDIALS ${SUNDIALS_VERSION}: ${SUNDIALS_DIR}")
if(sundials_wheel)
  unset(SUNDIALS_DIR CACHE) # look at the machine first next time, too
endif()

# CVODES does all that CVODE does, by the same calls, and is the one that the wheel has.
if(TARGET SUNDIALS::cvodes)
  list(APPEND components cvodes)
elseif(TARGET SUNDIALS::cvode)
  list(APPEND components cvode)
else()
  message(FATAL_ERROR "This SUNDIALS has neither CVODES nor CVODE: ${SUNDIALS_DIR}")
endif()

list(TRANSFORM components PREPEND SUNDIALS:: OUTPUT_VARIABLE libraries)
add_library(manutec_r3_sundials INTERFACE)
target_link_libraries(manutec_r3_sundials INTERFACE ${libraries})

# Libraries built for the Python bindings of SUNDIALS call functions that only these define.
unset(SUNDIALS_CALLS_PYTHON_HOOKS CACHE)
set(CMAKE_REQUIRED_LIBRARIES SUNDIALS::core)
set(CMAKE_REQUIRED_QUIET ON)
check_symbol_exists(SUNDIALS_ENABLE_PYTHON sundials/sundials_config.h SUNDIALS_CALLS_PYTHON_HOOKS)
unset(CMAKE_REQUIRED_LIBRARIES)
unset(CMAKE_REQUIRED_QUIET)
if(SUNDIALS_CALLS_PYTHON_HOOKS)
  add_library(manutec_r3_sundials_hooks OBJECT solver/sundials_python_hooks.c)
  set_target_properties(manutec_r3_sundials_hooks PROPERTIES
    POSITION_INDEPENDENT_CODE ON C_VISIBILITY_PRESET hidden)
  # As objects: a linker that meets a library before the calls to it would leave them out.
  target_link_libraries(manutec_r3_sundials INTERFACE $<TARGET_OBJECTS:manutec_r3_sundials_hooks>)
endif()
