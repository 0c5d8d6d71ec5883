# Writes abn_revision.h: project version, git revision (with -dirty where the tree differs), build type.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 OUTPUT_VARIABLE revision
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed OR revision STREQUAL "")
  set(revision unknown)
endif()
file(WRITE ${OUTPUT}.new "#pragma once\n#define ABN_VERSION \"${VERSION}\"\n#define ABN_REVISION \"${revision}\"\n#define ABN_BUILD_TYPE \"${BUILD_TYPE}\"\n")
execute_process(COMMAND ${CMAKE_COMMAND} -E copy_if_different ${OUTPUT}.new ${OUTPUT})
