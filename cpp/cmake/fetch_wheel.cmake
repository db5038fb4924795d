# fetch_wheel(<result> <requirements> <instead>)
#
# Downloads the one wheel that <requirements> pins by version and sha256, unpacks it in the build
# directory and stores the folder in <result>. A later configuration reuses the folder; its name
# carries the pin, so that a changed pin is fetched anew. <instead> tells a user whose download
# fails what else would do.
function(fetch_wheel result requirements instead)
  cmake_path(GET requirements STEM name)
  file(SHA256 "${requirements}" pin)
  string(SUBSTRING "${pin}" 0 12 pin)
  set(folder "${CMAKE_BINARY_DIR}/wheels/${name}-${pin}")
  set(${result} "${folder}" PARENT_SCOPE)
  if(EXISTS "${folder}")
    return()
  endif()

  if(NOT Python_EXECUTABLE)
    message(FATAL_ERROR "${name} is not installed, and without Python it cannot be fetched.\n"
                        "${instead}")
  endif()

  # Only headers and static libraries are used, which fit every Python: the version named here is
  # the one the wheel asks for, not the one that runs.
  set(command "${Python_EXECUTABLE}" -m pip download --quiet --disable-pip-version-check
      --no-deps --only-binary=:all: --python-version 3.12
      --require-hashes --requirement "${requirements}" --dest "${folder}.download")
  list(JOIN command " " shown)
  message(STATUS "Fetching ${name}: ${shown}")
  file(REMOVE_RECURSE "${folder}.download" "${folder}.unpacked")
  execute_process(COMMAND ${command} RESULT_VARIABLE failure OUTPUT_VARIABLE said
                  ERROR_VARIABLE said)
  if(failure)
    message(FATAL_ERROR "${name} is not installed and could not be fetched.\n"
                        "Tried: ${shown}\n${said}\n${instead}")
  endif()

  file(GLOB wheel "${folder}.download/*.whl")
  file(ARCHIVE_EXTRACT INPUT "${wheel}" DESTINATION "${folder}.unpacked")
  # Last, in one move: an interrupted run leaves no folder that looks complete.
  file(RENAME "${folder}.unpacked" "${folder}")
  file(REMOVE_RECURSE "${folder}.download")
endfunction()
