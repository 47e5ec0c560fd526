# The Debian packages, by cpack -G DEB (scripts/package calls it): dea, and dea-lab, the bench.
# Libraries that it needs are found by dpkg-shlibdeps; here is what is run as a program, or loaded by name.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME dea)
set(CPACK_PACKAGE_VENDOR "libdea developers")
set(CPACK_PACKAGE_CONTACT "libdea developers <libdea@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "design and simulation of dielectric elastomer actuators")
set(CPACK_DEBIAN_CORE_DESCRIPTION "The command dea computes stretch, field, displacement, force and safety\n\
margins of soft actuators against voltage, from one file that describes the\n\
film, its electrodes and its frame; it draws figures, writes a report and files\n\
for the workshop. With it come the library libdea for C, Python and Octave,\n\
examples, and a catalogue of materials.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/package_texts.cmake)
set(CPACK_SOURCE_GENERATOR "")

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL core)
if(DEA_LAB)
  list(APPEND CPACK_COMPONENTS_ALL lab)
endif()
set(CPACK_DEBIAN_CORE_PACKAGE_NAME dea)
set(CPACK_DEBIAN_LAB_PACKAGE_NAME dea-lab)
set(CPACK_DEBIAN_LAB_DESCRIPTION "the bench of dea: measurements of dielectric elastomer actuators (experimental)\n\
The commands dea drive, reduce, recording and import play a protocol on\n\
instruments or on a simulated bench, and reduce what was recorded.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
file(WRITE ${PROJECT_BINARY_DIR}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_CORE_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/triggers)
set(CPACK_DEBIAN_CORE_PACKAGE_DEPENDS "gnuplot-nox | gnuplot-qt | gnuplot-x11, fonts-dejavu-core, python3, python3-cffi-backend, \
python3-numpy")
set(CPACK_DEBIAN_LAB_PACKAGE_DEPENDS "dea (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_CORE_PACKAGE_RECOMMENDS "libopenblas0-serial | libopenblas0, gmsh")
set(CPACK_DEBIAN_CORE_PACKAGE_SUGGESTS "octave-dev, paraview")
include(CPack)
