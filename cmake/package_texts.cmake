# What Debian wants of the texts of a package: the licence as "copyright", a
# list of changes in its form, and compressed manual pages. cpack runs it on what it has installed for the package.
set(doc ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX}/share/doc/dea)
file(READ ${doc}/LICENSE licence)
file(WRITE ${doc}/copyright "${licence}\nThe module of model 3d loads PETSc and SuiteSparse, parts of which are under the GPL (see \
/usr/share/common-licenses/GPL-2): with that module, this package may be passed on under its terms only.\n")
file(REMOVE ${doc}/LICENSE)
file(GLOB manuals ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX}/share/man/man1/*.1)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${doc}/changelog "${CPACK_PACKAGE_NAME} (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n\
  * What changed: CHANGELOG.md, beside this file.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
execute_process(COMMAND gzip -9n ${doc}/changelog ${manuals} COMMAND_ERROR_IS_FATAL ANY)

# What lintian asks for and this package does otherwise.
set(overrides ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX}/share/lintian/overrides)
file(MAKE_DIRECTORY ${overrides})
file(WRITE ${overrides}/${CPACK_PACKAGE_NAME} "\
# One package on purpose: the library, its header and the command come together, of one version.\n\
${CPACK_PACKAGE_NAME}: link-to-shared-library-in-wrong-package\n\
${CPACK_PACKAGE_NAME}: package-name-doesnt-match-sonames\n")
