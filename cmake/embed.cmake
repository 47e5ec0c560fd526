# dea_embed(OUT NAME [FILE]...): OUT, in the current binary folder, is a C file with the bytes of the files, one after
# the other and ended by a zero, as `const char dea_asset_NAME[]`, and `const size_t dea_asset_NAME_length`.
#
# Run as a script at build time: cmake -DOUT=... -DNAME=... -DFILES=a;b -P embed.cmake
function(dea_embed out name)
  set(to ${CMAKE_CURRENT_BINARY_DIR}/${out})
  add_custom_command(OUTPUT ${to}
    COMMAND ${CMAKE_COMMAND} -DOUT=${to} -DNAME=${name} "-DFILES=${ARGN}" -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
endfunction()

if(CMAKE_SCRIPT_MODE_FILE)
  set(bytes)
  foreach(file IN LISTS FILES)
    file(READ ${file} hex HEX)
    string(APPEND bytes "${hex}")
  endforeach()
  string(LENGTH "${bytes}" digits)
  math(EXPR length "${digits} / 2")
  # as signs and not as numbers, which do not fit above 127
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(REPEAT "'[^']*'," 16 sixteen)
  string(REGEX REPLACE "(${sixteen})" "\\1\n" bytes "${bytes}")
  file(WRITE ${OUT} "#include <stddef.h>\n\nextern const char dea_asset_${NAME}[];\nextern const size_t dea_asset_${NAME}_length;\n\
const char dea_asset_${NAME}[] = {\n${bytes}'\\0'};\n\
const size_t dea_asset_${NAME}_length = ${length};\n")
endif()
