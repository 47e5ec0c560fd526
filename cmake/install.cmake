# Install rules: library, command, headers, data, examples, manual page, completions, libdea.pc.

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME core) # the other one is lab
install(TARGETS libdea dea
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})

get_property(modules GLOBAL PROPERTY DEA_MODULES)
list(REMOVE_ITEM modules dea_matio_module)
if(modules)
  install(TARGETS ${modules} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/dea)
endif()

# The one public header.
install(FILES ${PROJECT_SOURCE_DIR}/src/api/dea.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

foreach(folder IN ITEMS materials schema)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/${folder} DESTINATION ${CMAKE_INSTALL_DATADIR}/dea
    PATTERN ".gitkeep" EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/dea
  PATTERN ".gitkeep" EXCLUDE PATTERN "*.run" EXCLUDE)

# The package for Octave and MATLAB; its MEX file is compiled where it is used (dea_build.m).
install(DIRECTORY ${PROJECT_SOURCE_DIR}/matlab DESTINATION ${CMAKE_INSTALL_DATADIR}/dea
  FILES_MATCHING PATTERN "*.m" PATTERN "*.c")

install(FILES ${PROJECT_BINARY_DIR}/src/dea.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${PROJECT_BINARY_DIR}/src/completion.bash RENAME dea
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(DEA_LAB)
  install(TARGETS dea-lab RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT lab)
  if(TARGET dea_matio_module)
    install(TARGETS dea_matio_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/dea COMPONENT lab)
  endif()
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/lab/docs DESTINATION ${CMAKE_INSTALL_DOCDIR}/lab COMPONENT lab)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/lab/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/dea/lab COMPONENT lab)
endif()

# A program that links the static library needs its dependencies too; one that links the shared
# library does not. udunits and HDF5 are given by path: their packages name their .pc files
# differently from one distribution to the next.
set(DEA_PC_PACKAGES "yaml-0.1 jansson libmd cminpack expat")
set(DEA_PC_LIBRARIES ${UDUNITS2_LIBRARY} ${DEA_HEAVY_SHARED})
if(DEA_STATIC)
  set(DEA_PC_LIBRARIES ${UDUNITS2_LIBRARY} ${DEA_LAPACK_LIBRARIES} ${HDF5_C_LIBRARIES})
endif()
# of what HDF5 names, the static one needs no more than these
list(FILTER DEA_PC_LIBRARIES INCLUDE REGEX "hdf5|udunits|lapack|blas|gfortran|libsz|libz\\.")
list(REMOVE_DUPLICATES DEA_PC_LIBRARIES)
list(JOIN DEA_PC_LIBRARIES " " DEA_PC_LIBRARIES)
if(NOT DEA_STATIC)
  set(DEA_PC_DEPENDENCIES "Requires.private: ${DEA_PC_PACKAGES}\nLibs: -L\${libdir} -ldea\n\
Libs.private: ${DEA_PC_LIBRARIES} -lm")
else()
  set(DEA_PC_DEPENDENCIES "Requires: ${DEA_PC_PACKAGES}\n\
Libs: -L\${libdir} -ldea ${DEA_PC_LIBRARIES} -lm")
endif()
# From where libdea.pc is, so that `cmake --install --prefix` elsewhere holds.
set(DEA_PC_PREFIX "${CMAKE_INSTALL_PREFIX}")
if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  file(RELATIVE_PATH up "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
  string(REGEX REPLACE "/$" "" up "${up}")
  set(DEA_PC_PREFIX "\${pcfiledir}/${up}")
endif()
foreach(kind IN ITEMS LIB INCLUDE DATA)
  if(IS_ABSOLUTE "${CMAKE_INSTALL_${kind}DIR}")
    set(DEA_PC_${kind}DIR "${CMAKE_INSTALL_${kind}DIR}")
  else()
    set(DEA_PC_${kind}DIR "\${prefix}/${CMAKE_INSTALL_${kind}DIR}")
  endif()
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/libdea.pc.in ${PROJECT_BINARY_DIR}/libdea.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/libdea.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
