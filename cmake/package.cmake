# The Debian package, by cpack -G DEB (scripts/package calls it): all that is installed, in one package.
# Libraries that it needs are found by dpkg-shlibdeps; here is what is run as a program, or loaded by name.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME dea)
set(CPACK_PACKAGE_VENDOR "libdea developers")
set(CPACK_PACKAGE_CONTACT "libdea developers <libdea@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "design and simulation of dielectric elastomer actuators")
set(CPACK_PACKAGE_DESCRIPTION "The command dea computes stretch, field, displacement, force and safety\n\
margins of soft actuators against voltage, from one file that describes the\n\
film, its electrodes and its frame; it draws figures, writes a report, files\n\
for the workshop, and plays and reduces measurements. With it come the library\n\
libdea for C, Python and Octave, examples, and a catalogue of materials.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/package_texts.cmake)
set(CPACK_SOURCE_GENERATOR "")

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
file(WRITE ${PROJECT_BINARY_DIR}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/triggers)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "gnuplot-nox | gnuplot-qt | gnuplot-x11, fonts-dejavu-core, python3, python3-cffi-backend, \
python3-numpy")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libopenblas0-serial | libopenblas0, gmsh")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "octave-dev, paraview")
include(CPack)
