# Provides manutec_r3_fmi_headers: the C headers of FMI 2.0 and 3.0, published by the Modelica
# Association under a 2-clause BSD licence; FMPy brings them along. FMI_HEADERS names another folder.
set(FMI_HEADERS "" CACHE PATH "Folder of fmi2Functions.h and fmi3Functions.h; empty: fetched")
if(FMI_HEADERS)
  set(headers "${FMI_HEADERS}")
else()
  fetch_wheel(fmpy_wheel "${CMAKE_CURRENT_LIST_DIR}/fmpy.txt"
    "Instead, set FMI_HEADERS to a folder with the headers of FMI 2.0 and 3.0.")
  set(headers "${fmpy_wheel}/fmpy/c-code")
endif()
foreach(header fmi2Functions.h fmi3Functions.h)
  if(NOT EXISTS "${headers}/${header}")
    message(FATAL_ERROR "${header} is not in ${headers}")
  endif()
endforeach()
add_library(manutec_r3_fmi_headers INTERFACE)
target_include_directories(manutec_r3_fmi_headers SYSTEM INTERFACE "${headers}")
