# OpenCV's modules as imported targets, named as its own package configuration names them.
# Debian ships that configuration only in libopencv-dev, which pulls in every module and their dependencies; the
# module packages (libopencv-core-dev, ...) bring headers and libraries alone. So: the configuration where it is, else
# the files themselves.
find_package(OpenCV ${OpenCV_FIND_VERSION} QUIET CONFIG COMPONENTS ${OpenCV_FIND_COMPONENTS})
if(NOT OpenCV_FOUND)
    find_path(OpenCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
    foreach(_module IN LISTS OpenCV_FIND_COMPONENTS)
        find_library(OpenCV_${_module}_LIBRARY opencv_${_module})
        find_path(OpenCV_${_module}_HEADER opencv2/${_module}.hpp HINTS ${OpenCV_INCLUDE_DIR})
        if(OpenCV_${_module}_LIBRARY AND OpenCV_${_module}_HEADER)
            set(OpenCV_${_module}_FOUND TRUE)
        endif()
        mark_as_advanced(OpenCV_${_module}_LIBRARY OpenCV_${_module}_HEADER)
    endforeach()
    mark_as_advanced(OpenCV_INCLUDE_DIR)

    if(OpenCV_INCLUDE_DIR AND EXISTS ${OpenCV_INCLUDE_DIR}/opencv2/core/version.hpp)
        file(READ ${OpenCV_INCLUDE_DIR}/opencv2/core/version.hpp _text)
        foreach(_part IN ITEMS MAJOR MINOR REVISION)
            string(REGEX MATCH "#define CV_VERSION_${_part} +([0-9]+)" _line "${_text}")
            list(APPEND _version ${CMAKE_MATCH_1})
        endforeach()
        list(JOIN _version . OpenCV_VERSION)
        unset(_version)
    endif()

    include(FindPackageHandleStandardArgs)
    find_package_handle_standard_args(OpenCV REQUIRED_VARS OpenCV_INCLUDE_DIR VERSION_VAR OpenCV_VERSION
                                      HANDLE_COMPONENTS)
    if(OpenCV_FOUND)
        foreach(_module IN LISTS OpenCV_FIND_COMPONENTS)
            if(NOT TARGET opencv_${_module})
                add_library(opencv_${_module} SHARED IMPORTED)
                set_target_properties(opencv_${_module} PROPERTIES IMPORTED_LOCATION ${OpenCV_${_module}_LIBRARY}
                                      INTERFACE_INCLUDE_DIRECTORIES ${OpenCV_INCLUDE_DIR})
            endif()
        endforeach()
    endif()
endif()
