# Tests of the project as a whole rather than of one module.
find_program(BASH bash REQUIRED)

function(dif_project_test name)
    add_test(NAME ${name} COMMAND ${ARGN} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
    set_tests_properties(${name} PROPERTIES LABELS fast TIMEOUT 300)
endfunction()

dif_project_test(layers ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -P tests/layers.cmake)
dif_project_test(audit_catches ${BASH} tests/audit_catches ${CMAKE_SOURCE_DIR} ${CMAKE_COMMAND})

# Sanitizers and coverage keep mutable objects of their own, so only a plain build can be searched for ours.
set(archives)
set(flags)
if(DIF_SANITIZE)
    set(flags -fsanitize=address,undefined)
elseif(DIF_COVERAGE)
    set(flags --coverage)
else()
    foreach(layer dif_core dif_io dif_fixtures dif_gpu dif_bench dif_reports)
        list(APPEND archives $<TARGET_FILE:${layer}>)
    endforeach()
endif()
dif_project_test(audit ${BASH} tests/audit ${CMAKE_SOURCE_DIR} ${archives})

if(TARGET diffbench)
    dif_project_test(installed ${BASH} tests/installed ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR} ${CMAKE_COMMAND}
                     ${CMAKE_C_COMPILER} ${CMAKE_CXX_COMPILER} ${flags})
    dif_project_test(readme ${BASH} tests/cli/test_readme.sh ${CMAKE_SOURCE_DIR}/README.md $<TARGET_FILE:diffbench>)
endif()
