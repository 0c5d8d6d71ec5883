# The libraries of the harness. OpenImageIO's and OpenCV's own CMake files want packages that a build does not need
# (openimageio-tools, the whole of libopencv-dev), so these two are found by header and library.
find_package(Eigen3 3.3 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)

function(abn_find_library target header include_suffix)
  find_path(${target}_INCLUDE ${header} PATH_SUFFIXES ${include_suffix})
  set(libraries)
  foreach(name IN LISTS ARGN)
    find_library(${target}_${name} ${name})
    list(APPEND libraries ${${target}_${name}})
    if(NOT ${target}_${name})
      message(FATAL_ERROR "Library ${name} not found. Install the packages that abn.sh lists, or run ./abn.sh once.")
    endif()
  endforeach()
  if(NOT ${target}_INCLUDE)
    message(FATAL_ERROR "Header ${header} not found. Install the packages that abn.sh lists, or run ./abn.sh once.")
  endif()
  add_library(${target} INTERFACE)
  target_include_directories(${target} SYSTEM INTERFACE ${${target}_INCLUDE})
  target_link_libraries(${target} INTERFACE ${libraries})
endfunction()
abn_find_library(abn_openimageio OpenImageIO/imagebuf.h "" OpenImageIO OpenImageIO_Util)
abn_find_library(abn_opencv opencv2/imgproc.hpp opencv4 opencv_imgproc opencv_core)

# Version and git revision for the reproducibility record, refreshed by every build, rewritten only when it changes.
add_custom_target(abn_revision
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DOUTPUT=${PROJECT_BINARY_DIR}/generated/abn_revision.h
    -DVERSION=${PROJECT_VERSION} -DBUILD_TYPE=${CMAKE_BUILD_TYPE} -P ${PROJECT_SOURCE_DIR}/cmake/revision.cmake
  BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/abn_revision.h VERBATIM)

function(abn_configure_harness target)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR} PRIVATE ${PROJECT_BINARY_DIR}/generated)
  target_compile_definitions(${target} PRIVATE ABN_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    ABN_INSTALL_DATADIR="${CMAKE_INSTALL_FULL_DATADIR}/abn" $<$<BOOL:${ABN_HAVE_CUDA}>:ABN_HAVE_CUDA>)
  target_link_libraries(${target} PUBLIC abn_analysis abn_sampling nlohmann_json::nlohmann_json fmt::fmt abn_opencv abn_openimageio
    PRIVATE abn_internal Eigen3::Eigen tomlplusplus::tomlplusplus CLI11::CLI11)
  if(ABN_HAVE_CUDA)
    target_link_libraries(${target} PRIVATE abn_sph_cuda)
  endif()
  set_source_files_properties(${PROJECT_SOURCE_DIR}/harness/truth.cpp ${PROJECT_SOURCE_DIR}/harness/kriging_solve.cpp
    ${PROJECT_SOURCE_DIR}/harness/edge_reconstruction.cpp PROPERTIES COMPILE_OPTIONS "-O3;-fopenmp-simd;-fno-trapping-math")
  add_dependencies(${target} abn_revision)
endfunction()

# Tests that run whole programs: abn as a user calls it, and the procedural apple built at two optimisation levels.
function(abn_add_program_tests)
  if(NOT ABN_TESTS)
    return()
  endif()
  add_test(NAME program COMMAND ${PROJECT_SOURCE_DIR}/harness/program_test.sh $<TARGET_FILE:abn> ${PROJECT_SOURCE_DIR})
  set_tests_properties(program PROPERTIES LABELS program)
  target_link_libraries(harness_test PRIVATE tomlplusplus::tomlplusplus Eigen3::Eigen)
  foreach(level 0 3)
    add_executable(apple_hash_O${level} harness/apple_hash_main.cpp harness/apple_analytic.cpp harness/image_write.cpp)
    target_compile_options(apple_hash_O${level} PRIVATE -O${level})
    target_link_libraries(apple_hash_O${level} PRIVATE abn_sampling abn_openimageio fmt::fmt abn_internal)
  endforeach()
  add_test(NAME apple_hash COMMAND sh -c "a=$($<TARGET_FILE:apple_hash_O0> 300) && b=$($<TARGET_FILE:apple_hash_O3> 300) && echo \"$a $b\" && [ -n \"$a\" ] && [ \"$a\" = \"$b\" ]")
  set_tests_properties(apple_hash PROPERTIES LABELS unit)
endfunction()
