# HDF5 and LAPACK: static ones for the command and its modules. As shared libraries they take longer to load
# than most commands to run: HDF5 brings 25 libraries of network clients along, LAPACK an optimised BLAS that
# sets itself up, of which systems of thirty unknowns have nothing. libdea.so takes the shared ones: the static
# ones are not made for shared libraries, and what loads it (Python, Octave) often has them already.
#
# A program with PETSc in it has the property DEA_SHARED_BLAS: the linker takes the static BLAS into it wherever
# the shared one stands on its line, and PETSc and MUMPS would then use that slow one.
#
# Sets HDF5_INCLUDE_DIRS, HDF5_C_LIBRARIES, DEA_LAPACK_LIBRARIES, the same as DEA_LAPACK_LINK for targets, whose
# property chooses, and DEA_HEAVY_SHARED of libdea.so.
set(HDF5_USE_STATIC_LIBRARIES ON)
find_library(DEA_LAPACKE_A NAMES liblapacke.a)
find_library(DEA_LAPACK_A NAMES liblapack.a PATH_SUFFIXES lapack)
find_library(DEA_BLAS_A NAMES libblas.a PATH_SUFFIXES blas)
find_library(DEA_GFORTRAN NAMES gfortran libgfortran.so.5)
find_package(HDF5 REQUIRED COMPONENTS C)
pkg_check_modules(DEA_LAPACKE REQUIRED lapacke)
if(DEA_LAPACKE_A AND DEA_LAPACK_A AND DEA_BLAS_A AND DEA_GFORTRAN)
  set(blas ${DEA_BLAS_A})
  if(DEA_BLAS_FOUND)
    set(blas $<IF:$<BOOL:$<TARGET_PROPERTY:DEA_SHARED_BLAS>>,${DEA_BLAS_LINK_LIBRARIES},${DEA_BLAS_A}>)
  endif()
  set(DEA_LAPACK_LIBRARIES ${DEA_LAPACKE_A} ${DEA_LAPACK_A} ${DEA_BLAS_A} ${DEA_GFORTRAN})
  set(DEA_LAPACK_LINK ${DEA_LAPACKE_A} ${DEA_LAPACK_A} ${blas} ${DEA_GFORTRAN})
else()
  set(DEA_LAPACK_LIBRARIES ${DEA_LAPACKE_LINK_LIBRARIES})
  set(DEA_LAPACK_LINK ${DEA_LAPACK_LIBRARIES})
endif()
find_library(DEA_HDF5_SO NAMES hdf5_serial hdf5 REQUIRED)
set(DEA_HEAVY_SHARED ${DEA_HDF5_SO} ${DEA_LAPACKE_LINK_LIBRARIES})
