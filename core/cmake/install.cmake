# The binary, one shared library of all layers below the command line, its headers and a pkg-config file.

# Every header of core, core/io, fixtures, gpu and bench is public or internal; tests/audit holds this list to the tree.
set(DIF_PUBLIC_HEADERS
    core/alloc.h core/brdf.h core/colour.h core/conventions.h core/direct.h core/domain.h core/fft.h core/field.h core/footprint.h
    core/evaluator.h core/fresnel.h core/grating.h core/hemisphere.h core/kernel.h core/lut.h core/lut_filter.h core/mesh.h core/meso.h core/model.h core/nmm.h core/plan.h core/prep.h core/pyramid.h core/replica.h core/response.h
    core/raster.h core/scene.h core/series.h core/shade.h core/shadow.h core/sheet.h core/slope.h core/spectrum.h core/stam.h core/status.h core/thesis.h core/transfer.h core/units.h core/vec.h
    core/window.h
    core/io/directions.h core/io/field_io.h core/io/file.h core/io/hemisphere_io.h core/io/frame_io.h core/io/image_cv.h core/io/lut_io.h core/io/manifest.h
    core/io/map_io.h core/io/obj_tiny.h core/io/panel_picture.h core/io/table_io.h
    fixtures/meshes.h fixtures/surfaces.h
    gpu/gpu.h gpu/gpu_render.h
    bench/compare_methods.h bench/energy.h bench/filter_study.h bench/fit.h bench/lut_check.h bench/map.h bench/maxima.h bench/measure.h bench/model_build.h bench/regress.h bench/regress_limits.h bench/regress_run.h bench/table_cut.h
    bench/scan.h bench/slopes.h bench/view.h)

add_library(dif_shared SHARED $<TARGET_OBJECTS:dif_core> $<TARGET_OBJECTS:dif_io> $<TARGET_OBJECTS:dif_fixtures>
            $<TARGET_OBJECTS:dif_gpu> $<TARGET_OBJECTS:dif_bench>)
set_target_properties(dif_shared PROPERTIES OUTPUT_NAME diffbench VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} LINKER_LANGUAGE CXX
                      LINK_DEPENDS ${CMAKE_SOURCE_DIR}/core/cmake/exports.map)
target_link_libraries(dif_shared PRIVATE dif_flags m OpenMP::OpenMP_C OpenEXR::OpenEXRCore opencv_core opencv_imgproc
                      opencv_imgcodecs PkgConfig::ZIP PkgConfig::EXPAT PkgConfig::ZLIB tinyobjloader::tinyobjloader_double Ceres::ceres PkgConfig::EPOXY ${CMAKE_DL_LIBS})
target_link_options(dif_shared PRIVATE LINKER:--version-script=${CMAKE_SOURCE_DIR}/core/cmake/exports.map)
if(NOT DIF_SANITIZE)
    target_link_options(dif_shared PRIVATE LINKER:--no-undefined)
endif()

install(TARGETS dif_shared LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET diffbench)
    install(TARGETS diffbench RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
foreach(header IN LISTS DIF_PUBLIC_HEADERS)
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/diffbench/${folder})
endforeach()
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The pkg-config file finds its prefix from its own place, so that `cmake --install --prefix` and moves work.
file(RELATIVE_PATH DIF_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(core/cmake/diffbench.pc.in diffbench.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/diffbench.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
