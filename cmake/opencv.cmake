# gimbald_find_opencv(component...): a target opencv_COMPONENT for each that is there. Debian's whole
# libopencv-dev brings CMake files and 400 packages; the packages of single components come without.
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
function(gimbald_find_opencv)
  foreach(component ${ARGN})
    find_library(OPENCV_${component}_LIBRARY opencv_${component})
    if(OPENCV_INCLUDE_DIR AND OPENCV_${component}_LIBRARY AND NOT TARGET opencv_${component})
      add_library(opencv_${component} UNKNOWN IMPORTED GLOBAL)
      set_target_properties(opencv_${component} PROPERTIES
        IMPORTED_LOCATION "${OPENCV_${component}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${OPENCV_INCLUDE_DIR}")
    endif()
  endforeach()
endfunction()
