# What Debian wants of the texts of a package: the licence as "copyright", a
# list of changes in its form, and compressed manual pages. cpack runs it on what it has installed for the packages.
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(share ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${component}${CPACK_PACKAGING_INSTALL_PREFIX}/share)
  file(READ ${CPACK_RESOURCE_FILE_LICENSE} licence)
  file(WRITE ${share}/doc/${package}/copyright "${licence}\nThe module of model 3d loads PETSc and SuiteSparse, parts of which \
are under the GPL (see /usr/share/common-licenses/GPL-2): with that module, this package may be passed on under its terms only.\n\nThe page of dea studio has \
CodeMirror in it, (C) Marijn Haverbeke and others, under the MIT licence: its text is in the package libjs-codemirror.\n")
  file(REMOVE ${share}/doc/${package}/LICENSE)
  file(GLOB manuals ${share}/man/man1/*.1)
  string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(WRITE ${share}/doc/${package}/changelog "${package} (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n\
  * What changed: CHANGELOG.md of package dea.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  execute_process(COMMAND gzip -9n ${share}/doc/${package}/changelog ${manuals} COMMAND_ERROR_IS_FATAL ANY)
endforeach()

# What lintian asks for and package dea does otherwise.
file(WRITE ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/core${CPACK_PACKAGING_INSTALL_PREFIX}/share/lintian/overrides/dea "\
# One package on purpose: the library, its header and the command come together, of one version.\n\
dea: link-to-shared-library-in-wrong-package\n\
dea: package-name-doesnt-match-sonames\n")
