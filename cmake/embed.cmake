# dea_embed(OUT NAME FILE... [NAME FILE...]...): a C file with the bytes of files as `const char dea_asset_NAME[]`
# (several files one after the other, ended by a zero) and `const size_t dea_asset_NAME_length`.
#
# Called as a script too, at build time: cmake -DOUT=... -DNAME=... -DFILES=a;b -P embed.cmake
function(dea_embed out name)
  add_custom_command(OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -DOUT=${out} -DNAME=${name} "-DFILES=${ARGN}" -P
      ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
endfunction()

if(CMAKE_SCRIPT_MODE_FILE)
  set(bytes)
  foreach(file IN LISTS FILES)
    file(READ ${file} hex HEX)
    string(APPEND bytes ${hex})
  endforeach()
  string(LENGTH "${bytes}" digits)
  math(EXPR length "${digits} / 2")
  # a char above 127 needs its sign
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(REGEX REPLACE "(('[^']*',)('[^']*',)('[^']*',)('[^']*',)('[^']*',)('[^']*',)('[^']*',)('[^']*',))" "\\1\n" bytes "${bytes}")
  file(WRITE ${OUT} "#include \"output/report/assets.h\"\n\nconst char dea_asset_${NAME}[] = {\n${bytes}'\\0'};\n\
const size_t dea_asset_${NAME}_length = ${length};\n")
endif()
