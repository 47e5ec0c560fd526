# HDF5 and LAPACK: static where our library is static too. As shared libraries they take longer to load than
# most commands to run: HDF5 brings 25 libraries of network clients along, LAPACK an optimised BLAS that sets
# itself up, of which systems of thirty unknowns have nothing.
#
# Sets HDF5_INCLUDE_DIRS, HDF5_C_LIBRARIES, and DEA_LAPACK_LIBRARIES.
if(NOT BUILD_SHARED_LIBS)
  set(HDF5_USE_STATIC_LIBRARIES ON)
  find_library(DEA_LAPACKE_A NAMES liblapacke.a)
  find_library(DEA_LAPACK_A NAMES liblapack.a PATH_SUFFIXES lapack)
  find_library(DEA_BLAS_A NAMES libblas.a PATH_SUFFIXES blas)
  find_library(DEA_GFORTRAN NAMES gfortran libgfortran.so.5)
endif()
find_package(HDF5 REQUIRED COMPONENTS C)
if(DEA_LAPACKE_A AND DEA_LAPACK_A AND DEA_BLAS_A AND DEA_GFORTRAN)
  set(DEA_LAPACK_LIBRARIES ${DEA_LAPACKE_A} ${DEA_LAPACK_A} ${DEA_BLAS_A} ${DEA_GFORTRAN})
else()
  pkg_check_modules(DEA_LAPACKE REQUIRED lapacke)
  set(DEA_LAPACK_LIBRARIES ${DEA_LAPACKE_LINK_LIBRARIES})
endif()
